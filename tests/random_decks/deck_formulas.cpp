#include "random_decks/deck_formulas.hpp"

#include <fmt/format.h>

#include <array>

namespace pwlsim::test {

std::string DeckFormulas::of_parameters(const DeckScope& scope, int depth) {
  if (depth == 0 || random_.chance(0.2))
    return scope.parameters.empty() || random_.chance(0.5) ? values_.factor() : random_.one_of(scope.parameters);
  const std::string a = of_parameters(scope, depth - 1), b = of_parameters(scope, depth - 1), c = of_parameters(scope, depth - 1);
  if (!scope.functions.empty() && random_.chance(0.15)) return fmt::format("{}({})", random_.one_of(scope.functions), a);
  const char* form = random_.one_of(std::array{"{0}+{1}",
                                               "({0}+{1})/2",
                                               "{0}*{1}",
                                               "{0}/({1})",
                                               "({0})**0.5",
                                               "{0}^2",
                                               "-{0}",
                                               "abs({0}-{1})",
                                               "min({0},{1})",
                                               "max({0},{1},{2})",
                                               "sqrt(abs({0}))",
                                               "exp(-abs({0}))",
                                               "ln(1+abs({0}))",
                                               "log10(10*abs({0})+1)",
                                               "1+0.1*sin({0})",
                                               "cos({0})",
                                               "tan({0}/4)",
                                               "atan({0})",
                                               "atan2({0},{1})",
                                               "asin(0.5)+{0}",
                                               "acos(0.2)*{0}",
                                               "sinh({0})",
                                               "cosh({0})",
                                               "tanh({0})",
                                               "pow(abs({0}),0.3)",
                                               "floor({0}+1)",
                                               "ceil({0})",
                                               "int({0}+1)",
                                               "sgn({0})",
                                               "limit({0},{1},{2})",
                                               "if({0}>{1},{2},1)",
                                               "{0}<{1}?{2}:{0}",
                                               "({0}>=1 && {1}<2) ? {2} : 1",
                                               "!({0}) + 1",
                                               "ternary_fcn({0}>1,{1},{2})",
                                               "pi*{0}/e",
                                               "gauss(0.1)+{0}",
                                               "mc({0},0.1)",
                                               "agauss({0},0.1,3)",
                                               "unif({0},0.2)",
                                               "flat(0.1)+{1}"});
  return fmt::format(fmt::runtime(form), a, b, c);
}

std::string DeckFormulas::signal(const DeckScope& scope) {
  if (!scope.measurable.empty() && random_.chance(0.25))
    return fmt::format("{}({})", random_.one_of(std::array{"I", "i"}), random_.one_of(scope.measurable));
  if (random_.chance(0.3)) return fmt::format("V({},{})", node(scope), node(scope));
  return fmt::format("{}({})", random_.one_of(std::array{"V", "v"}), node(scope));
}

std::string DeckFormulas::of_time() {
  const std::string f = values_.frequency(0.05, 1.0), t = values_.time(1.0, 20.0);
  const char* form =
      random_.one_of(std::array{"sin(2*pi*{0}*time)", "cos({0}*time+1)", "exp(-time/{1})", "time/{1}", "(time>{1})", "u(time-{1})",
                                "exp(-time/{1})*sin({0}*time)", "time*sin({0}*time)", "time*time", "sqrt(time)"});
  return fmt::format(fmt::runtime(form), f, t);
}

std::string DeckFormulas::table(const DeckScope& scope, int depth) {
  std::string text = fmt::format("{}({}", random_.one_of(std::array{"table", "pwl"}), of_signals(scope, depth));
  double x = random_.between(-3.0, 0.0);
  for (int points = random_.whole(1, 4); points > 0; --points) {
    text += fmt::format(",{:.3g},{:.3g}", x, random_.between(-3.0, 3.0));
    if (!random_.chance(0.15)) x += random_.between(0.1, 2.0);
  }
  return text + ")";
}

std::string DeckFormulas::condition(const DeckScope& scope, int depth) {
  const std::string a = of_signals(scope, depth), b = random_.chance(0.5) ? values_.volts() : of_signals(scope, 0);
  const std::string simple = fmt::format("{}{}{}", a, random_.one_of(std::array{"<", ">", "<=", ">="}), b);
  if (depth == 0 || random_.chance(0.8)) return simple;
  return fmt::format("{} {} {}{}", simple, random_.one_of(std::array{"&&", "||", "&", "|"}), random_.chance(0.2) ? "!" : "",
                     condition(scope, 0));
}

std::string DeckFormulas::of_signals(const DeckScope& scope, int depth) {
  if (depth == 0 || random_.chance(0.15)) {
    if (random_.chance(0.1)) return of_time();
    if (random_.chance(0.2)) return values_.volts();
    return random_.chance(0.5) ? signal(scope) : fmt::format("{}*{}", values_.factor(), signal(scope));
  }
  if (random_.chance(0.12)) return table(scope, depth - 1);
  const std::string a = of_signals(scope, depth - 1), b = of_signals(scope, depth - 1);
  if (random_.chance(0.15)) {
    const std::string c = condition(scope, depth - 1);
    return random_.chance(0.5) ? fmt::format("({}) ? {} : {}", c, a, b) : fmt::format("if({},{},{})", c, a, b);
  }
  if (!scope.functions.empty() && random_.chance(0.05)) return fmt::format("{}({})", random_.one_of(scope.functions), a);
  if (random_.chance(0.02))
    return fmt::format(
        fmt::runtime(random_.one_of(std::array{"({})*({})", "({})/({})", "sqrt({})+{}", "({})**2+{}", "floor({})*{}", "ddt({})+{}"})), a,
        b);
  const char* form = random_.one_of(std::array{"{0}+{1}", "{0}-{1}", "{2}*({0})", "({0})/{2}", "-({0})", "max({0},{1})", "min({0},{1})",
                                               "max({0},{1},{2})", "abs({0})", "uramp({0})", "limit({0},-{2},{2})", "limit({0},{2},0)",
                                               "sgn({0})", "u({0})", "{2}*u({0})-{1}"});
  return fmt::format(fmt::runtime(form), a, b, values_.factor());
}

std::string DeckFormulas::measured(const DeckScope& scope, int depth) {
  if (depth == 0 || random_.chance(0.3)) return random_.chance(0.85) ? signal(scope) : random_.chance(0.5) ? values_.factor() : "time";
  const std::string a = measured(scope, depth - 1), b = measured(scope, depth - 1);
  const char* form = random_.one_of(std::array{"{0}*{1}",
                                               "{0}+{1}",
                                               "{0}-{1}",
                                               "-{0}",
                                               "abs({0})",
                                               "max({0},{1})",
                                               "({0})**2",
                                               "sqrt(abs({0}))",
                                               "{0}/({1})",
                                               "{0}/(1+abs({1}))",
                                               "if({0}>{1},{0},{1})",
                                               "exp(-abs({0}))",
                                               "{0}>{1}",
                                               "sin({0})",
                                               "sgn({0})",
                                               "limit({0},{1},1)",
                                               "ln({0})",
                                               "({0})**8",
                                               "floor({0})",
                                               "u({0})*{1}",
                                               "atan2({0},{1})"});
  return fmt::format(fmt::runtime(form), a, b);
}

}  // namespace pwlsim::test
