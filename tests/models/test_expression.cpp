/// Vector fields given as text: values, exact derivatives, decimal numbers, precedence, and the one line every kind of bad text gives.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "models/equilibrium_model.hpp"
#include "models/expression.hpp"

using namespace whirl;
using namespace whirl::models;

namespace {

double value(const std::string& text, double x = 0.7, double y = 1.3) {
  const VectorField f({text}, {"x", "y"});
  const double in[] = {x, y};
  double out = 0.0;
  f.evaluate<double>(in, std::span<double>(&out, 1));
  return out;
}

std::string refusal(const std::vector<std::string>& equations, const std::vector<std::string>& inputs = {"x", "y", "q2"}) {
  try {
    const VectorField f(equations, inputs);
  } catch (const ExpressionError& e) {
    CHECK(std::string(e.what()).find('\n') == std::string::npos);
    return e.what();
  }
  return "accepted";
}

EquilibriumModel carbon_monoxide() {
  return {.variables = {"x", "y", "s"},
          .parameters = {{"q1", 2.5}, {"q2", 1.0}, {"q3", 10.0}, {"q4", 0.0675}, {"q5", 1.0}, {"q6", 0.1}, {"k", 0.4}},
          .rhs = {"2*q1*(1-x-y-s)^2 - 2*q5*x^2 - q3*x*y", "q2*(1-x-y-s) - q6*y - q3*x*y", "q4*((1-x-y-s) - k*s)"},
          .initial = {0.01, 0.02, 0.4}};
}

struct Written {  // carbon_monoxide with q2 and k free, by hand
  template <class S>
  void residual(std::span<const S> u, std::span<S> r) const {
    const S z = 1.0 - u[0] - u[1] - u[2];
    r[0] = 5.0 * z * z - 2.0 * u[0] * u[0] - 10.0 * u[0] * u[1];
    r[1] = u[3] * z - 0.1 * u[1] - 10.0 * u[0] * u[1];
    r[2] = 0.0675 * (z - u[4] * u[2]);
  }
};

}  // namespace

TEST_CASE("decimal numbers in the text are the nearest doubles") {
  CHECK(value("0.0675") == 0.0675);
  CHECK(value("0.1 + 0.2") == 0.1 + 0.2);
  CHECK(value("1e-300") == 1e-300);
  CHECK(value("3.513830719125161") == 3.513830719125161);
  CHECK(value("2.2250738585072014e-308") == 2.2250738585072014e-308);
  CHECK(value("123456789012345678901234567890") == 123456789012345678901234567890.0);
  CHECK(value(".5e1") == 5.0);
  CHECK(value("1/3") == 1.0 / 3.0);
  CHECK(value("pi") == std::numbers::pi);
}

TEST_CASE("precedence, signs and functions of text are those of arithmetic") {
  const double x = 0.7, y = 1.3;
  const std::pair<const char*, double> cases[] = {{"-x^2", -x * x},
                                                  {"(-x)^2", x * x},
                                                  {"1 - x - y", 1.0 - x - y},
                                                  {"1 - (x - y)", 1.0 - (x - y)},
                                                  {"x/y/2", x / y / 2.0},
                                                  {"x/(y*2)", x / (y * 2.0)},
                                                  {"x/y*2", x / y * 2.0},
                                                  {"-x*y + 2", -x * y + 2.0},
                                                  {"x*(-y) + 2", -x * y + 2.0},
                                                  {"+x - (+y)", x - y},
                                                  {"2*x^3*y", 2.0 * x * x * x * y},
                                                  {"x^7", std::pow(x, 7)},
                                                  {"x^(-2)", 1.0 / (x * x)},
                                                  {"1/x^2 + 3/(1+x)", 1.0 / (x * x) + 3.0 / (1.0 + x)},
                                                  {"x^0.5", std::sqrt(x)},
                                                  {"x^(1/3)", std::cbrt(x)},
                                                  {"x^2.5", std::pow(x, 2.5)},
                                                  {"x^(-1.5)", std::pow(x, -1.5)},
                                                  {"x^y", std::pow(x, y)},
                                                  {"2^x", std::exp2(x)},
                                                  {"(x^2)^y", std::pow(x * x, y)},
                                                  {"x*x*x - x^3", 0.0},
                                                  {"exp(x)*log(y)", std::exp(x) * std::log(y)},
                                                  {"sin(x) + cos(y)*tan(x)", std::sin(x) + std::cos(y) * std::tan(x)},
                                                  {"sinh(x) - cosh(y)/tanh(x)", std::sinh(x) - std::cosh(y) / std::tanh(x)},
                                                  {"atan(x/y) + sqrt(x+y) + abs(x-y)", std::atan(x / y) + std::sqrt(x + y) + std::abs(x - y)},
                                                  {"sqrt(2)*x", std::sqrt(2.0) * x},
                                                  {"1/sqrt(x)", 1.0 / std::sqrt(x)},
                                                  {"(1-x-y)^2/(1+(1-x-y)^2)", (1 - x - y) * (1 - x - y) / (1 + (1 - x - y) * (1 - x - y))}};
  for (const auto& [text, expected] : cases) {
    INFO(text);
    CHECK(value(text) == Approx(expected).epsilon(4e-15).margin(1e-16));  // a few roundings: terms may be summed in another order
  }
  CHECK(value("abs(x)", -2.0) == 2.0);
  CHECK(value("sqrt(x^2)", -2.0) == 2.0);
}

TEST_CASE("maximum, minimum and sign") {
  const double x = 0.7, y = 1.3;
  const std::pair<const char*, double> cases[] = {{"max(x, y)", y},
                                                  {"min(x,y)", x},
                                                  {"max(y, x) - max(x, y)", 0.0},
                                                  {"2*max(-x, -y)^2 + 1", 2.0 * x * x + 1.0},
                                                  {"max(1e-20, -1)", 1e-20},
                                                  {"max(x, 1) + min(x, 1)", 1.0 + x},
                                                  {"max(x, max(y, 2))", 2.0},
                                                  {"min((x + y)*2, (x - y))", x - y},
                                                  {"sign(x - y)*sign(y - x)", -1.0},
                                                  {"sign(x - x) + sign(-y)", -1.0},
                                                  {"max(sin(x), cos(x))^0.5", std::sqrt(std::cos(x))}};
  for (const auto& [text, expected] : cases) {
    INFO(text);
    CHECK(value(text) == Approx(expected).epsilon(4e-15).margin(1e-16));
  }
  const std::pair<const char*, const char*> refused[] = {{"max(x)", "takes two values"},
                                                         {"max(x, y, x)", "takes two values"},
                                                         {"abs(x, y)", "takes one value"},
                                                         {"(x, y)", "','"},
                                                         {"x, y", "','"},
                                                         {"max(, y)", "missing before ','"},
                                                         {"max(x, )", "missing before ')'"},
                                                         {"max", "ends with"},
                                                         {"sign x", "parentheses"},
                                                         {"maximum(x, y)", "unknown symbol"}};
  for (const auto& [text, why] : refused) {
    INFO(text);
    CHECK_THROWS_WITH(value(text), Catch::Contains(why));
  }
}

TEST_CASE("slopes beside and on corners are those of one side, no number stays none") {
  using D = Dual<Dual<double, 1>, 2>;
  const VectorField f({"max(x^2, y)", "min(x^2, y)", "sign(x)*x^2"}, {"x", "y"});
  const auto at = [&](double x, double y) {
    std::array<D, 2> in{D(x), D(y)};
    in[0].d[0] = 1.0;
    in[1].d[1] = 1.0;
    in[0].v.d[0] = 1.0;
    std::array<D, 3> out;
    f.evaluate<D>(in, out);
    return out;
  };
  const auto beside = at(2.0, 1.0);
  CHECK(beside[0].d[0].v == 4.0);
  CHECK(beside[0].d[0].d[0] == 2.0);
  CHECK(beside[0].d[1].v == 0.0);
  CHECK(beside[1].d[1].v == 1.0);
  CHECK(at(-2.0, 1.0)[2].d[0].v == 4.0);
  const double slope = at(1.0, 1.0)[0].d[0].v;
  CHECK((slope == 0.0 || slope == 2.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [x, y] : {std::pair{nan, 1.0}, std::pair{1.0, nan}}) CHECK(std::isnan(at(x, y)[0].v.v + at(x, y)[1].v.v));
  CHECK(std::isnan(at(nan, 1.0)[2].v.v));
  for (const auto& c : f.corners(std::vector{2.0, 1.0})) CHECK(std::abs(c.distance) == (c.op == Step::Op::sign ? 2.0 : 3.0));
  // Fixed numbers put into a field, and the slopes of a conserved maximum.
  const VectorField fixed = f.rebound({0, 3.0}, 1);
  double in = 2.0, out[3];
  fixed.evaluate<double>({&in, 1}, out);
  CHECK(out[0] == 4.0);
  CHECK(out[1] == 3.0);
}

TEST_CASE("names of inputs hide the constants of the reader") {
  const VectorField f({"I + Pi*Euler - pi + c0 + v1"}, {"I", "Pi", "Euler", "pi", "c0", "v1"});
  const double in[] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  double out = 0.0;
  f.evaluate<double>(in, std::span<double>(&out, 1));
  CHECK(out == 14.0);
}

TEST_CASE("derivatives of text are exact in nested duals") {
  // f = x^3 y + exp(x y) + x^2.5 / (1 + y^2), its derivatives by hand
  const VectorField f({"x^3*y + exp(x*y) + x^2.5/(1 + y^2)"}, {"x", "y"});
  using D = Dual<Dual<double, 2>, 2>;
  const double x = 0.8, y = 0.6, e = std::exp(x * y), q = 1.0 + y * y;
  std::array<D, 2> in;
  const double at[] = {x, y};
  for (std::size_t i = 0; i < 2; ++i) {
    in[i] = D(seed<Dual<double, 2>>(at[i], static_cast<int>(i)));
    in[i].d[i] = 1.0;
  }
  D out;
  f.evaluate<D>(in, std::span<D>(&out, 1));
  CHECK(out.v.v == Approx(x * x * x * y + e + std::pow(x, 2.5) / q).epsilon(1e-14));
  CHECK(out.v.d[0] == Approx(3 * x * x * y + y * e + 2.5 * std::pow(x, 1.5) / q).epsilon(1e-14));
  CHECK(out.v.d[1] == Approx(x * x * x + x * e - std::pow(x, 2.5) * 2 * y / (q * q)).epsilon(1e-14));
  CHECK(out.d[0].d[0] == Approx(6 * x * y + y * y * e + 3.75 * std::sqrt(x) / q).epsilon(1e-14));
  CHECK(out.d[0].d[1] == Approx(3 * x * x + e + x * y * e - 2.5 * std::pow(x, 1.5) * 2 * y / (q * q)).epsilon(1e-14));
}

TEST_CASE("the field from text equals the field written by hand, with all derivatives") {
  const EquilibriumFlow text(carbon_monoxide(), {"q2", "k"});
  const DualProblem<Written> hand({}, 3, 2, true);
  CHECK(text.parameter_names() == std::vector<std::string>{"q2", "k"});
  Vector u(5), a = Vector::Random(5), b = Vector::Random(5), c = Vector::Random(5), r(3), s(3);
  u << 0.03, 0.2, 0.5, 1.1, 0.4;
  Matrix j(3, 5), h(3, 5), i(3, 5), g(3, 5);
  text.linearise(u, r, j);
  hand.linearise(u, s, i);
  CHECK((r - s).norm() < 1e-15);  // rounding of sums of size 1
  CHECK((j - i).norm() < 1e-14);
  text.second(u, a, h);
  hand.second(u, a, g);
  CHECK((h - g).norm() < 1e-13);
  text.third(u, a, b, c, r);
  hand.third(u, a, b, c, s);
  CHECK((r - s).norm() < 1e-13);
  const double step = 1e-6;
  for (int k = 0; k < 5; ++k) {
    Vector up = u, down = u, rp(3), rm(3);
    up[k] += step;
    down[k] -= step;
    text.residual(up, rp);
    text.residual(down, rm);
    CHECK((j.col(k) - (rp - rm) / (2.0 * step)).norm() < 1e-8);  // second differences: step^2 and rounding / step
  }
}

TEST_CASE("fixed numbers are computed into the steps and shared parts run once") {
  const VectorField f({"a*b*x + c*(a+b)", "sin(x)^2 + sin(x)"}, {"x", "a", "b", "c"});
  const VectorField g = f.rebound({0, 2.0, 3.0, 4.0}, 1);
  CHECK(g.inputs() == 1);
  CHECK(g.steps().size() == 5);  // scale, offset; sin, square, sum
  double x = 0.3, out[2];
  g.evaluate<double>(std::span<const double>(&x, 1), out);
  CHECK(out[0] == Approx(6.0 * x + 20.0).epsilon(1e-15));
  CHECK(out[1] == Approx(std::sin(x) * std::sin(x) + std::sin(x)).epsilon(1e-15));
  CHECK_THROWS_AS(f.rebound({0, 1.0}, 1), std::invalid_argument);
  CHECK_THROWS_AS(VectorField({"x/a"}, {"x", "a"}).rebound({0, 0.0}, 1), std::invalid_argument);  // infinite whatever x
}

namespace {

/// Value, slopes and second derivatives of one expression in two inputs x and n, n free or fixed beforehand.
struct Second {
  double f, x, n, xx, xn;
};
Second second_of(const std::string& text, double x, double n) {
  using D = Dual<Dual<double, 2>, 2>;
  const VectorField f({text}, {"x", "n"});
  std::array<D, 2> in = {D(seed<Dual<double, 2>>(x, 0)), D(seed<Dual<double, 2>>(n, 1))};
  for (std::size_t i = 0; i < 2; ++i) in[i].d[i] = 1.0;
  D out;
  f.evaluate<D>(in, std::span<D>(&out, 1));
  return {out.v.v, out.v.d[0], out.v.d[1], out.d[0].d[0], out.d[0].d[1]};
}
Second fixed_exponent(const std::string& text, double x, double n) {
  using D = Dual<Dual<double, 1>, 1>;
  const VectorField f = VectorField({text}, {"x", "n"}).rebound({0, n}, 1);
  D in(seed<Dual<double, 1>>(x, 0)), out;
  in.d[0] = 1.0;
  f.evaluate<D>(std::span<const D>(&in, 1), std::span<D>(&out, 1));
  return {out.v.v, out.v.d[0], 0.0, out.d[0].d[0], 0.0};
}

}  // namespace

TEST_CASE("a whole exponent that is a parameter is a whole exponent, free or fixed") {
  for (const double x : {-1.7, -1.0, -0.3, 0.0, 0.3, 1.0, 1.7})
    for (const int n : {0, 1, 2, 3, 4, 5, 7, 10}) {
      INFO("x = " << x << ", n = " << n);
      const auto power_of = [x](int k) { return k < 0 ? 0.0 : std::pow(x, k); };
      const double f = power_of(n), fx = n * power_of(n - 1), fxx = n * (n - 1) * power_of(n - 2);
      for (const Second& at : {fixed_exponent("x^n", x, n), second_of("x^n", x, n)}) {
        CHECK(at.f == Approx(f).epsilon(1e-14).margin(1e-300));
        CHECK(at.x == Approx(fx).epsilon(1e-14).margin(1e-300));
      }
      CHECK(fixed_exponent("x^n", x, n).xx == Approx(fxx).epsilon(1e-14).margin(1e-300));
      if (x > 0.0) {
        const Second at = second_of("x^n", x, n);
        CHECK(at.xx == Approx(fxx).epsilon(1e-14).margin(1e-300));
        CHECK(at.n == Approx(f * std::log(x)).epsilon(1e-14).margin(1e-300));
        CHECK(at.xn == Approx(std::pow(x, n - 1) + fx * std::log(x)).epsilon(1e-14).margin(1e-14));
      }
      if (x < 0.0) CHECK(std::isnan(second_of("x^n", x, n).n));  // no real power beside a whole one
    }
  CHECK(fixed_exponent("x^n", -2.0, -3.0).f == Approx(-0.125).epsilon(1e-15));
  CHECK(fixed_exponent("x^n", -2.0, -3.0).x == Approx(-3.0 / 16.0).epsilon(1e-15));
  CHECK(second_of("x^n", -2.0, -3.0).f == Approx(-0.125).epsilon(1e-15));
  CHECK(second_of("x^n", -2.0, 1e9 + 1.0).f == -std::numeric_limits<double>::infinity());  // odd
  CHECK(second_of("n^x", 3.0, -2.0).f == -8.0);
  CHECK(value("(-x)^y", 2.0, 3.0) == -8.0);
  CHECK(value("(-2)^y", 0.0, 3.0) == -8.0);
  CHECK(value("0^y", 0.0, 3.0) == 0.0);
  CHECK(value("0^y", 0.0, 0.0) == 1.0);
}

TEST_CASE("slopes of powers at zero are those from above") {
  for (const double n : {1.5, 2.0, 2.5, 3.0, 3.5, 4.0}) {
    INFO("n = " << n);
    const Second at = second_of("x^n", 0.0, n);
    CHECK(at.f == 0.0);
    CHECK(at.x == 0.0);
    CHECK(at.n == 0.0);   // 0^n = 0 for all n > 0
    CHECK(at.xn == 0.0);  // x^(n-1) (1 + n log x) -> 0
    if (n > 2.0) CHECK(at.xx == 0.0);
  }
  CHECK(second_of("x^n", 0.0, 2.0).xx == 2.0);
  CHECK(second_of("x^n", 0.0, 1.0).x == 1.0);
  CHECK(std::isinf(second_of("x^n", 0.0, 1.5).xx));
  CHECK(std::isinf(second_of("x^n", 0.0, 0.5).x));
  CHECK(std::isinf(second_of("x^n", 0.0, -1.0).f));
}

TEST_CASE("an infinite slope in one input leaves the others' alone") {
  using D = Dual<double, 2>;
  for (const char* text : {"x^0.5 + 3*y", "sqrt(x) + 3*y", "x^0.3 + 3*y"}) {
    const VectorField f({text}, {"x", "y"});
    const D in[] = {seed<D>(0.0, 0), seed<D>(2.0, 1)};
    D out;
    f.evaluate<D>(in, std::span<D>(&out, 1));
    CHECK(out.v == 6.0);
    CHECK(std::isinf(out.d[0]));
    CHECK(out.d[1] == 3.0);
  }
}

TEST_CASE("Hill functions with the exponent as a parameter equal those with the power written out") {
  const std::pair<const char*, const char*> pairs[] = {{"a*x^n/(1 + x^n)", "a*x^2/(1 + x^2)"},
                                                       {"a/(1 + x^n) - x", "a/(1 + x^2) - x"},
                                                       {"x^n*(1 - x)^n", "x^2*(1 - x)^2"},
                                                       {"(x^n + a)^n", "(x^2 + a)^2"},
                                                       {"x^(2*n) - x^n", "x^4 - x^2"},
                                                       {"x^(-n) + x^(n+1)", "x^(-2) + x^3"},
                                                       {"a^n*x^n", "a^2*x^2"},
                                                       {"(x/a)^n/(1 + (x/a)^n)", "(x/a)^2/(1 + (x/a)^2)"},
                                                       {"(-x)^n + (-x)^(n+1)", "x^2 - x^3"},
                                                       {"x*x^n*x", "x^4"},
                                                       {"x^n/x^n + sin(x)^n", "1 + sin(x)^2"}};
  for (const auto& [with, without] : pairs)
    for (const double x : {-1.3, -0.2, 0.4, 2.0}) {
      INFO(with << " at " << x);
      using D = Dual<double, 1>;
      const VectorField f = VectorField({with}, {"x", "a", "n"}).rebound({0, 0.7, 2.0}, 1),
                        g = VectorField({without}, {"x", "a"}).rebound({0, 0.7}, 1);
      const D in = seed<D>(x, 0);
      D a, b;
      f.evaluate<D>(std::span<const D>(&in, 1), std::span<D>(&a, 1));
      g.evaluate<D>(std::span<const D>(&in, 1), std::span<D>(&b, 1));
      CHECK(a.v == Approx(b.v).epsilon(1e-14).margin(1e-14));
      CHECK(a.d[0] == Approx(b.d[0]).epsilon(1e-13).margin(1e-13));
    }
}

TEST_CASE("a value that is not finite is told by what makes it so") {
  const auto why = [](const std::string& text, double x, double y) {
    const double in[] = {x, y};
    return VectorField({text}, {"x", "y"}).not_finite(in);
  };
  CHECK(why("x^y", -1.0, 2.5) == "(-1)^2.5: a negative number has whole powers only");
  CHECK(why("x^y", 0.0, -1.0) == "0^(-1) is infinite");
  CHECK(why("x^1.5", -2.0, 0.0) == "(-2)^1.5: a negative number has whole powers only");
  CHECK(why("y*log(x)", -0.5, 1.0) == "log(-0.5) is not a real number");
  CHECK(why("sqrt(x - y)", 1.0, 2.0) == "sqrt(-1) is not a real number");
  CHECK(why("x/y", 1.0, 0.0) == "a division by zero");
  CHECK(why("1/(x - y)", 2.0, 2.0) == "a division by zero");
  CHECK(why("exp(x)", 1000.0, 0.0) == "a value too large for a number");
  CHECK(why("x^y", -1.0, 3.0).empty());
  CHECK_THROWS_WITH(VectorField({"(-2)^n*x"}, {"x", "n"}).rebound({0, 0.5}, 1), Catch::Contains("(-2)^0.5 is not a real number"));
}

TEST_CASE("bad text gives one line with the equation's number") {
  CHECK(refusal({"x", "q9*y"}) == "equation 2: unknown symbol 'q9', did you mean q2?");
  CHECK(refusal({"zebra*y"}) == "equation 1: unknown symbol 'zebra'; known are x, y, q2");
  CHECK(refusal({"sine(x)"}) == "equation 1: unknown symbol 'sine', did you mean sin?");
  CHECK(refusal({"(x + (y)"}) == "equation 1: unbalanced: 1 '(' not closed");
  CHECK(refusal({"x + y)"}) == "equation 1: unbalanced: ')' at character 6 closes nothing");
  CHECK(refusal({""}) == "equation 1: is empty");
  CHECK(refusal({"  "}) == "equation 1: is empty");
  CHECK(refusal({"x +"}) == "equation 1: ends with '+' where a value must follow");
  CHECK(refusal({"2x"}) == "equation 1: '2' and 'x' stand side by side at character 2: write * between them");
  CHECK(refusal({"2(x)"}) == "equation 1: '2' and '(' stand side by side at character 2: write * between them");
  CHECK(refusal({"x(y)"}) == "equation 1: 'x' and '(' stand side by side at character 2: write * between them");
  CHECK(refusal({"x*-y"}) == "equation 1: a sign behind '*' needs parentheses at character 3");
  CHECK(refusal({"x--y"}) == "equation 1: a sign behind '-' needs parentheses at character 3");
  CHECK(refusal({"x^y^2"}) == "equation 1: x^y^z needs parentheses at character 4");
  CHECK(refusal({"x^(y)^2"}) == "equation 1: x^y^z needs parentheses at character 6");
  CHECK(refusal({"x**2"}) == "equation 1: a value is missing before '*' at character 3");
  CHECK(refusal({"()"}) == "equation 1: a value is missing before ')' at character 2");
  CHECK(refusal({"sin x"}) == "equation 1: function sin needs parentheses: sin(...)");
  CHECK(refusal({"sin + x"}) == "equation 1: function sin needs parentheses: sin(...)");
  CHECK(refusal({"sin(x, y)"}) == "equation 1: function sin takes one value");
  CHECK(refusal({"x = y"}) == "equation 1: '=' at character 3 is not understood");
  CHECK(refusal({"x\xc2\xb2"}) == "equation 1: a character that is not plain text at character 2");
  CHECK(refusal({"1.2.3"}) == "equation 1: not a number at character 1");
  CHECK(refusal({"1e999"}) == "equation 1: the number 1e999 is out of range");
  CHECK(refusal({"x/(y-y)"}) == "equation 1: divides by zero");
  CHECK(refusal({"x + 1/0"}) == "equation 1: is not a finite number");
  CHECK(refusal({"1/0"}) == "equation 1: is not a finite number");
  CHECK(refusal({"log(0)*x"}) == "equation 1: is not a finite number");
  CHECK(refusal({"9^9^9"}) == "equation 1: x^y^z needs parentheses at character 4");
  CHECK(refusal({"(9^9)^(9^9)"}) == "equation 1: is not a finite number");  // and not a number of 10^9 digits
  CHECK(refusal({std::string(300, '(') + "x" + std::string(300, ')')}) == "equation 1: more than 200 parentheses in each other");
  CHECK(refusal({std::string(20001, 'x')}) == "equation 1: longer than 20000 characters");
  CHECK(refusal({"x"}, {"x", "x"}) == "the name 'x' is given twice");
  CHECK(refusal({"x"}, {"x", "2y"}) == "'2y' is no name: letters, digits and _ only, a letter first");
  CHECK(refusal({"x"}, {"sin"}) == "'sin' is the name of a function");
}

TEST_CASE("mirrors are tested against the equations") {
  EquilibriumModel m{.variables = {"x", "y"},
                     .parameters = {{"mu", 0.1}, {"tilt", 0.0}},
                     .rhs = {"mu*x - x^3 + tilt + x*y", "x^2 - y"},
                     .initial = {0.1, 0.0},
                     .mirrors = {{{"x"}, "WH"}}};
  const EquilibriumFlow flow(m, {"mu"});
  REQUIRE(flow.reflections().size() == 1);
  CHECK(flow.reflections()[0].signs == Eigen::Vector2d(-1.0, 1.0));
  CHECK(flow.reflections()[0].subtype == "WH");
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"tilt"}), "changing the sign of x changes the equations: no symmetry");
  m.mirrors = {{{"x", "y"}}};
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"mu"}), "changing the sign of x, y changes the equations: no symmetry");
  m.mirrors = {{{"w"}}};
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"mu"}), "a reflection of 'w', which is no variable; the variables are x, y");
  m.mirrors = {};
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"nu"}), "no parameter 'nu'; the model has mu, tilt");
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"mu", "mu"}), "the parameter mu is free twice");
  m.initial = {0.1};
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"mu"}), "1 initial values for 2 variables");
  m.rhs = {"x"};
  CHECK_THROWS_WITH(EquilibriumFlow(m, {"mu"}), "1 equations for 2 variables");
}
