#pragma once
// A small table of reference numbers beside the tests: lines of '#' are comments, then a line of names, then numbers.
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

struct CsvTable {
  std::map<std::string, std::vector<double>> columns;
  std::size_t rows = 0;

  explicit CsvTable(const std::string& name) {
    std::ifstream in(std::string(WHIRL_SOURCE_DIR) + "/tests/models/" + name);
    if (!in) throw std::runtime_error("no " + name);
    std::vector<std::string> names;
    for (std::string line, cell; std::getline(in, line);) {
      if (line.starts_with('#')) continue;
      std::stringstream cells(line);
      const bool first = names.empty();
      for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) first ? names.push_back(cell) : columns[names.at(i)].push_back(std::stod(cell));
      rows += first ? 0 : 1;
    }
  }
  bool has(const std::string& name) const { return columns.contains(name); }
  double operator()(const std::string& name, std::size_t row) const { return columns.at(name).at(row); }
};
