#include "analysis/trial_run.hpp"

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "analysis/listener.hpp"

namespace pwlsim::analysis {
namespace {

/// Tells them when the run counts.
class Keeper : public Listener {
 public:
  Keeper(const engine::Request& request, engine::RowSink& rows) : Listener(request, rows) {}

  [[nodiscard]] engine::Answer run(const Simulate& simulate) { return simulate(request_, *this); }
  [[nodiscard]] bool has_passed_on() const { return passes_on_; }
  /// False where the rows are not wanted any more.
  bool pass_on() {
    passes_on_ = true;
    for (const Told& told : std::exchange(told_, {})) std::visit([this](const auto& what) { tell(what); }, told);
    return accepts_;
  }

  bool write(std::span<const double> values, std::size_t count) override {
    keep(Rows{{values.begin(), values.end()}, count}, values.size());
    return accepts_;
  }
  void begin(std::span<const std::string> elements, std::span<const char> on) override {
    keep(Begin{{elements.begin(), elements.end()}, {on.begin(), on.end()}}, 4 * elements.size());
  }
  void happened(const engine::Event& event, std::span<const char> on) override {
    keep(Happened{event, {on.begin(), on.end()}}, on.size() / sizeof(double));
  }
  void before_start(std::span<const double> values) override { keep(BeforeStart{{values.begin(), values.end()}}, values.size()); }
  void take(const engine::Piece& piece) override {
    keep(Taken{piece, {piece.values.begin(), piece.values.end()}, {piece.noise.begin(), piece.noise.end()}},
         piece.values.size() + piece.noise.size());
  }
  void impulse(double time, std::span<const double> values) override {
    keep(TakenImpulse{time, {values.begin(), values.end()}}, values.size());
  }

 private:
  struct Rows {
    std::vector<double> values;
    std::size_t count;
  };
  struct Begin {
    std::vector<std::string> elements;
    std::vector<char> on;
  };
  struct Happened {
    engine::Event event;
    std::vector<char> on;
  };
  struct BeforeStart {
    std::vector<double> values;
  };
  struct Taken {
    engine::Piece piece;
    std::vector<double> values, noise;
  };
  struct TakenImpulse {
    double time;
    std::vector<double> values;
  };
  using Told = std::variant<Rows, Begin, Happened, BeforeStart, Taken, TakenImpulse>;

  template <class What>
  void keep(What what, std::size_t numbers) {
    if (passes_on_) return tell(what);
    told_.push_back(std::move(what));
    size_ += sizeof(Told) + sizeof(double) * numbers;
    if (size_ > trial_memory) (void)pass_on();
  }

  void tell(const Rows& rows) { accepts_ = accepts_ && rows_.write(rows.values, rows.count); }
  void tell(const Begin& begin) { watcher_->begin(begin.elements, begin.on); }
  void tell(const Happened& happened) { watcher_->happened(happened.event, happened.on); }
  void tell(const BeforeStart& start) { pieces_->before_start(start.values); }
  void tell(const Taken& taken) {
    engine::Piece piece = taken.piece;
    piece.values = taken.values;
    piece.noise = taken.noise;
    pieces_->take(piece);
  }
  void tell(const TakenImpulse& impulse) { pieces_->impulse(impulse.time, impulse.values); }

  std::vector<Told> told_;
  std::size_t size_ = 0;  ///< of what is kept, bytes
  bool passes_on_ = false, accepts_ = true;
};

bool has_failed(engine::Outcome outcome) {
  return outcome == engine::Outcome::no_solution || outcome == engine::Outcome::not_unique || outcome == engine::Outcome::accumulation;
}

}  // namespace

Simulate tried_first(Simulate first, Other other, std::function<engine::Remark(const engine::Answer&)> why) {
  return [first = std::move(first), other = std::move(other), why = std::move(why)](const engine::Request& request, engine::RowSink& sink) {
    Keeper keeper(request, sink);
    engine::Answer answer = keeper.run(first);
    if (const Simulate second = keeper.has_passed_on() ? Simulate{} : other(answer); second) {
      engine::Answer next = second(request, sink);
      next.remarks.push_back(why(answer));
      return next;
    }
    if (!keeper.pass_on() && answer.outcome == engine::Outcome::completed) answer.outcome = engine::Outcome::sink_stopped;
    return answer;
  };
}

Simulate tried_first(Simulate first, Simulate second, std::function<engine::Remark(const engine::Answer&)> why) {
  const Other other = [second = std::move(second)](const engine::Answer& answer) {
    return has_failed(answer.outcome) ? second : Simulate{};
  };
  return tried_first(std::move(first), other, std::move(why));
}

}  // namespace pwlsim::analysis
