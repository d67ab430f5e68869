#include "analysis/abandonable_run.hpp"

#include <memory>
#include <mutex>
#include <utility>

#include "analysis/abandonable.hpp"
#include "analysis/listener.hpp"

namespace pwlsim::analysis {
namespace {

/// Lives as long as the engine may run.
class Gate : public Listener {
 public:
  Gate(const engine::Request& request, engine::RowSink& rows) : Listener(request, rows), progress_(request.progress) {
    if (progress_) request_.progress = [this](double time) { pass([&] { progress_(time); }); };
  }

  void run(const Simulate& simulate) { answer = simulate(request_, *this); }
  /// Nothing passes any more. The answer is then this one.
  [[nodiscard]] engine::Answer close() {
    const std::scoped_lock lock(mutex_);
    is_closed_ = true;
    engine::Answer interrupted;
    interrupted.outcome = engine::Outcome::interrupted;
    interrupted.id = "E-interrupted";
    interrupted.time = last_time_;
    interrupted.probed = probed_;
    return interrupted;
  }

  bool write(std::span<const double> values, std::size_t count) override {
    bool accepted = false;
    pass([&] {
      accepted = rows_.write(values, count);
      if (count != 0) last_time_ = values[values.size() / count * (count - 1)];
    });
    return accepted;
  }
  void begin(std::span<const std::string> elements, std::span<const char> on) override {
    pass([&] { watcher_->begin(elements, on); });
  }
  void happened(const engine::Event& event, std::span<const char> on) override {
    pass([&] { watcher_->happened(event, on); });
  }
  void before_start(std::span<const double> values) override {
    pass([&] { pieces_->before_start(values); });
  }
  void take(const engine::Piece& piece) override {
    pass([&] {
      pieces_->take(piece);
      probed_ = piece.to;
    });
  }
  void impulse(double time, std::span<const double> values) override {
    pass([&] { pieces_->impulse(time, values); });
  }

  engine::Answer answer;

 private:
  template <class Tell>
  void pass(const Tell& tell) {
    const std::scoped_lock lock(mutex_);
    if (!is_closed_) tell();
  }

  std::function<void(double)> progress_;
  std::mutex mutex_;
  bool is_closed_ = false;
  double last_time_ = 0.0, probed_ = 0.0;
};

}  // namespace

Simulate abandonable(Simulate simulate, const std::atomic<int>& interrupt) {
  return [simulate = std::move(simulate), &interrupt](const engine::Request& request, engine::RowSink& sink) {
    const auto gate = std::make_shared<Gate>(request, sink);
    if (finished_in_time([gate, simulate] { gate->run(simulate); }, interrupt)) return std::move(gate->answer);
    return gate->close();
  };
}

}  // namespace pwlsim::analysis
