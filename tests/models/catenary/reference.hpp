#pragma once
/// Tables of reference numbers (tests/models/catenary/*.csv) and the catenaries they speak of.

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "models/catenary/cable.hpp"
#include "models/catenary/geometry.hpp"
#include "models/catenary/modes.hpp"

namespace catenary_test {

using namespace whirl;
using namespace whirl::models::catenary;

struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;

  std::size_t column(const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return i;
    FAIL("no column " << name);
    return 0;
  }
  const std::string& text(std::size_t row, const std::string& name) const { return rows[row].at(column(name)); }
  double operator()(std::size_t row, const std::string& name) const { return std::stod(text(row, name)); }
};

// Commas inside quotes do not occur.
inline Table table(const std::string& name) {
  std::ifstream in(std::string(WHIRL_SOURCE_DIR) + "/tests/models/catenary/" + name + ".csv");
  REQUIRE(in);
  Table t;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::stringstream s(line);
    for (std::string cell; std::getline(s, cell, ',');) cells.push_back(cell);
    if (t.names.empty()) t.names = cells;
    else {
      cells.resize(std::max(cells.size(), t.names.size()));
      t.rows.push_back(cells);
    }
  }
  REQUIRE(!t.rows.empty());
  return t;
}

inline Geometry by_sag(double sag_parameter, double height_over_span) { return unit_geometry(half_width_of(sag_parameter), height_over_span); }
inline CoreCable core(const Geometry& g, double kappa = 0.0) { return {.x1 = g.x1, .x2 = g.x2, .kappa = kappa}; }

}  // namespace catenary_test
