#include "models/expression_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace whirl::models {

using Op = Step::Op;

namespace {

constexpr int max_whole_exponent = 1000000;

double apply(Op op, double x) {
  const Step step{op};
  return VectorField::run<double>(step, &x);
}

Operand operand_a(const Step& s, const std::vector<Operand>& now) { return s.op == Op::constant ? fixed(0.0) : now[static_cast<std::size_t>(s.a)]; }
bool is_choice(Op op) { return op == Op::max || op == Op::min; }
bool takes_two(Op op) { return op == Op::add || op == Op::subtract || op == Op::multiply || op == Op::divide || op == Op::power || is_choice(op); }
Operand operand_b(const Step& s, const std::vector<Operand>& now) { return takes_two(s.op) ? now[static_cast<std::size_t>(s.b)] : fixed(0.0); }

}  // namespace

Operand Writer::add(const Operand& a, const Operand& b) {
  if (a.known && b.known) return fixed(a.number + b.number);
  if (a.known) return add(b, a);
  if (b.known) return b.number == 0.0 ? a : write({Op::offset, a.index, 0, b.number});
  return write({Op::add, a.index, b.index});
}

Operand Writer::subtract(const Operand& a, const Operand& b) {
  if (b.known) return add(a, fixed(-b.number));
  if (a.known) return add(multiply(b, fixed(-1.0)), a);
  return write({Op::subtract, a.index, b.index});
}

Operand Writer::multiply(const Operand& a, const Operand& b) {
  if (a.known && b.known) return fixed(a.number * b.number);
  if (a.known) return multiply(b, a);
  if (b.is(0.0)) return b;
  if (b.known) return b.number == 1.0 ? a : write({Op::scale, a.index, 0, b.number});
  return write({Op::multiply, a.index, b.index});
}

Operand Writer::divide(const Operand& a, const Operand& b) {
  if (a.known && b.known) return fixed(a.number / b.number);
  if (b.known) return multiply(a, fixed(1.0 / b.number));
  if (a.is(0.0)) return a;
  if (a.known) return write({Op::over, b.index, 0, a.number});
  return write({Op::divide, a.index, b.index});
}

Operand Writer::raise(const Operand& base, const Operand& exponent) {
  if (base.known && exponent.known) {
    const double value = std::pow(base.number, exponent.number);
    if (std::isnan(value)) throw std::domain_error(fmt::format("({:g})^{:g} is not a real number", base.number, exponent.number));
    return fixed(value);
  }
  if (exponent.known) return raise(base, exponent.number);
  if (base.known && base.number > 0.0) return call(Op::exp, multiply(exponent, fixed(std::log(base.number))));
  return write({Op::power, result(base), exponent.index});
}

Operand Writer::raise(const Operand& base, double y) {
  if (y == 0.0) return fixed(1.0);
  if (y == 1.0) return base;
  if (y == 2.0) return multiply(base, base);
  if (y == 3.0) return multiply(multiply(base, base), base);
  if (y < 0.0) return divide(fixed(1.0), raise(base, -y));
  if (y == 0.5) return call(Op::sqrt, base);
  if (y == std::floor(y) && y <= max_whole_exponent) return write({Op::whole_power, base.index, static_cast<int>(y)});
  return write({Op::real_power, base.index, 0, y});
}

Operand Writer::call(Op op, const Operand& a) { return a.known ? fixed(apply(op, a.number)) : write({op, a.index}); }

Operand Writer::choose(Op op, const Operand& a, const Operand& b) {
  if (!a.known || !b.known) return write({op, result(a), result(b)});
  const double both[] = {a.number, b.number};
  return fixed(VectorField::run<double>({op, 0, 1}, both));
}

Operand Writer::write(Step s) {
  if (!std::isfinite(s.number)) throw std::domain_error("is not a finite number");
  if ((s.op == Op::add || s.op == Op::multiply || is_choice(s.op)) && s.a > s.b) std::swap(s.a, s.b);
  const auto [it, fresh] = known_.try_emplace({s.op, s.a, s.b, s.number}, inputs_ + static_cast<int>(steps.size()));
  if (fresh) steps.push_back(s);
  return {false, 0.0, it->second};
}

Operand Writer::again(const Step& s, const Operand& a, const Operand& b) {
  switch (s.op) {
    case Op::constant:
      return fixed(s.number);
    case Op::add:
      return add(a, b);
    case Op::subtract:
      return subtract(a, b);
    case Op::multiply:
      return multiply(a, b);
    case Op::divide:
      return divide(a, b);
    case Op::offset:
      return add(a, fixed(s.number));
    case Op::scale:
      return multiply(a, fixed(s.number));
    case Op::over:
      return divide(fixed(s.number), a);
    case Op::whole_power:
      return raise(a, fixed(s.b));
    case Op::real_power:
      return raise(a, fixed(s.number));
    case Op::power:
      return raise(a, b);
    case Op::exp:
    case Op::log:
    case Op::sin:
    case Op::cos:
    case Op::tan:
    case Op::sinh:
    case Op::cosh:
    case Op::tanh:
    case Op::atan:
    case Op::sqrt:
    case Op::abs:
    case Op::sign:
      return call(s.op, a);
    case Op::max:
    case Op::min:
      return choose(s.op, a, b);
  }
  throw std::logic_error("no such step");
}

Operand Writer::slope(const Step& s, const Operand& a, const Operand& b, const Operand& y, const Operand& da, const Operand& db) {
  if (da.is(0.0) && (db.is(0.0) || !takes_two(s.op))) return fixed(0.0);
  const auto along_a = [&](const Operand& rate) { return multiply(rate, da); };
  const auto one_plus_square = [&](const Operand& x, double sign) { return add(multiply(multiply(x, x), fixed(sign)), fixed(1.0)); };
  switch (s.op) {
    case Op::constant:
      return fixed(0.0);
    case Op::add:
      return add(da, db);
    case Op::subtract:
      return subtract(da, db);
    case Op::multiply:
      return add(multiply(da, b), multiply(a, db));
    case Op::divide:
      return divide(subtract(da, multiply(y, db)), b);
    case Op::offset:
      return da;
    case Op::scale:
      return along_a(fixed(s.number));
    case Op::over:
      return along_a(divide(multiply(y, fixed(-1.0)), a));
    case Op::whole_power:
      return along_a(multiply(raise(a, fixed(s.b - 1)), fixed(s.b)));
    case Op::real_power:
      return along_a(multiply(raise(a, fixed(s.number - 1.0)), fixed(s.number)));
    case Op::power: {
      const Operand in_base = da.is(0.0) ? da : along_a(multiply(b, raise(a, add(b, fixed(-1.0)))));
      return db.is(0.0) ? in_base : add(in_base, multiply(db, multiply(y, call(Op::log, a))));
    }
    case Op::exp:
      return along_a(y);
    case Op::log:
      return divide(da, a);
    case Op::sin:
      return along_a(call(Op::cos, a));
    case Op::cos:
      return along_a(multiply(call(Op::sin, a), fixed(-1.0)));
    case Op::tan:
      return along_a(one_plus_square(y, 1.0));
    case Op::sinh:
      return along_a(call(Op::cosh, a));
    case Op::cosh:
      return along_a(call(Op::sinh, a));
    case Op::tanh:
      return along_a(one_plus_square(y, -1.0));
    case Op::atan:
      return divide(da, one_plus_square(a, 1.0));
    case Op::sqrt:
      return divide(multiply(da, fixed(0.5)), y);
    case Op::abs:
      return along_a(divide(a, y));
    case Op::sign:
      return fixed(0.0);
    case Op::max:
    case Op::min: {  // half of both slopes and half of their difference, with the sign of the side
      const Operand side = multiply(call(Op::sign, subtract(a, b)), fixed(s.op == Op::max ? 0.5 : -0.5));
      return add(multiply(add(da, db), fixed(0.5)), multiply(side, subtract(da, db)));
    }
  }
  throw std::logic_error("no such step");
}

// ------------------------------------------------------------------------------------------------------------ fields from fields

VectorField VectorField::rebound(const std::vector<Source>& sources, int new_inputs) const try {
  if (sources.size() != static_cast<std::size_t>(inputs_)) throw std::invalid_argument("one source for each input");
  Writer writer(new_inputs);
  std::vector<Operand> now;
  for (const auto& s : sources) now.push_back(std::holds_alternative<int>(s) ? writer.input(std::get<int>(s)) : fixed(std::get<double>(s)));
  for (const Step& s : steps_) now.push_back(writer.again(s, operand_a(s, now), operand_b(s, now)));
  VectorField field;
  field.inputs_ = new_inputs;
  for (const int r : results_) field.results_.push_back(writer.result(now[static_cast<std::size_t>(r)]));
  field.steps_ = std::move(writer.steps);
  return field;
} catch (const std::domain_error& e) {
  throw std::invalid_argument(fmt::format("the equations are not finite at these parameters, whatever the variables: a part {}", e.what()));
}

// d/dt of each c_k along the field is 0. The field returned draws c_k to its value at a rate of its own:
//
//   f - sum_k rate_k grad c_k (c_k - value_k)
VectorField VectorField::held(int variables, const std::vector<double>& values, const std::vector<double>& rates) const {
  const std::size_t wanted = results_.size() - values.size();
  Writer writer(inputs_);
  std::vector<Operand> now;
  for (int i = 0; i < inputs_; ++i) now.push_back(writer.input(i));
  for (const Step& s : steps_) now.push_back(writer.again(s, operand_a(s, now), operand_b(s, now)));
  const auto value = [&](std::size_t equation) { return now[static_cast<std::size_t>(results_[equation])]; };
  const std::vector<bool> needed = used_by(wanted);
  VectorField field;
  field.inputs_ = inputs_;
  for (std::size_t i = 0; i < wanted; ++i) {
    Operand f = value(i);
    if (static_cast<int>(i) < variables) {
      std::vector<Operand> slopes(now.size(), fixed(0.0));
      slopes[i] = fixed(1.0);
      for (std::size_t k = 0; k < steps_.size(); ++k) {
        const Step& s = steps_[k];
        const std::size_t at = static_cast<std::size_t>(inputs_) + k;
        if (needed[at]) slopes[at] = writer.slope(s, operand_a(s, now), operand_b(s, now), now[at], operand_a(s, slopes), operand_b(s, slopes));
      }
      for (std::size_t k = 0; k < values.size(); ++k) {
        const Operand off = writer.add(value(wanted + k), fixed(-values[k])), slope = slopes[static_cast<std::size_t>(results_[wanted + k])];
        f = writer.subtract(f, writer.multiply(writer.multiply(slope, fixed(rates[k])), off));
      }
    }
    field.results_.push_back(writer.result(f));
  }
  field.steps_ = std::move(writer.steps);
  return field;
}

// Registers that results from `first` on are computed from.
std::vector<bool> VectorField::used_by(std::size_t first) const {
  std::vector<bool> used(static_cast<std::size_t>(inputs_) + steps_.size(), false);
  for (std::size_t i = first; i < results_.size(); ++i) used[static_cast<std::size_t>(results_[i])] = true;
  for (std::size_t k = steps_.size(); k-- > 0;) {
    if (!used[static_cast<std::size_t>(inputs_) + k] || steps_[k].op == Op::constant) continue;
    used[static_cast<std::size_t>(steps_[k].a)] = true;
    if (takes_two(steps_[k].op)) used[static_cast<std::size_t>(steps_[k].b)] = true;
  }
  return used;
}

// ------------------------------------------------------------------------------------------------------------ what goes wrong where

std::string VectorField::not_finite(std::span<const double> x) const {
  std::vector<double> now(x.begin(), x.begin() + inputs_);
  for (const Step& s : steps_) {
    const double y = run<double>(s, now.data()), a = now[static_cast<std::size_t>(s.a)],
                 b = takes_two(s.op) ? now[static_cast<std::size_t>(s.b)] : s.number;
    now.push_back(y);
    if (std::isfinite(y) || !std::isfinite(a) || !std::isfinite(b)) continue;
    const auto power = [a](double exponent) {
      return a < 0.0 ? fmt::format("({:g})^{:g}: a negative number has whole powers only", a, exponent)
                     : fmt::format("{:g}^({:g}) is infinite", a, exponent);
    };
    switch (s.op) {
      case Op::divide:
      case Op::over:
        return (s.op == Op::divide ? b : a) == 0.0 ? "a division by zero" : "a quotient too large for a number";
      case Op::power:
        return power(b);
      case Op::real_power:
        return power(s.number);
      case Op::log:
      case Op::sqrt:
        return fmt::format("{}({:g}) is not a real number", s.op == Op::log ? "log" : "sqrt", a);
      case Op::constant:
      case Op::add:
      case Op::subtract:
      case Op::multiply:
      case Op::offset:
      case Op::scale:
      case Op::whole_power:
      case Op::exp:
      case Op::sin:
      case Op::cos:
      case Op::tan:
      case Op::sinh:
      case Op::cosh:
      case Op::tanh:
      case Op::atan:
      case Op::abs:
      case Op::sign:
      case Op::max:
      case Op::min:
        return "a value too large for a number";
    }
  }
  return "";
}

std::vector<VectorField::Corner> VectorField::corners(std::span<const double> x) const {
  std::vector<double> now(x.begin(), x.begin() + inputs_);
  std::vector<Corner> all;
  for (const Step& s : steps_) {
    const auto value = [&](int at) { return now[static_cast<std::size_t>(at)]; };
    if (s.op == Op::abs || s.op == Op::sign) all.push_back({s.op, value(s.a)});
    if (is_choice(s.op)) all.push_back({s.op, value(s.a) - value(s.b)});
    now.push_back(run<double>(s, now.data()));
  }
  return all;
}

}  // namespace whirl::models
