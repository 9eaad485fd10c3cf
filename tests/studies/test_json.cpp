#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "studies/json.hpp"

using namespace whirl::studies;

TEST_CASE("JSON is strictly valid whatever it holds", "[json]") {
  const auto text = [](const Json& value) {
    const std::string whole = value.text();
    return whole.substr(0, whole.size() - 1);
  };
  CHECK(text(Json()) == "null");
  CHECK(text(true) == "true");
  CHECK(text(0.1) == "0.1");
  CHECK(text(2.0) == "2");
  CHECK(text(-7) == "-7");
  CHECK(std::stod(text(1.0 / 3.0)) == 1.0 / 3.0);
  CHECK(text(1e300) == "1e+300");
  for (const double x : {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) CHECK(text(x) == "null");
  CHECK(text("a\"b\\c") == R"("a\"b\\c")");
  CHECK(text("a\nb\tc\x01") == R"("a\u000ab\u0009c\u0001")");
  CHECK(text("\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8c\x8d") == "\"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8c\x8d\"");
  // bytes that are no UTF-8: alone, overlong, a surrogate, beyond U+10FFFF, cut off
  CHECK(text("\xff") == R"("\ufffd")");
  CHECK(text("\xc0\xaf") == R"("\ufffd\ufffd")");
  CHECK(text("\xed\xa0\x80") == R"("\ufffd\ufffd\ufffd")");
  CHECK(text("\xf4\x90\x80\x80") == R"("\ufffd\ufffd\ufffd\ufffd")");
  CHECK(text("a\xe2\x82") == R"("a\ufffd\ufffd")");
}

TEST_CASE("JSON keeps the order of its members and refuses a key put twice", "[json]") {
  Json point = Json::object();
  point.put("type", "LP").put("omega", 1.25).put("bracket", Json::array(std::vector<double>{1.0, 2.0}));
  CHECK_THROWS_AS(point.put("omega", 2.0), std::logic_error);
  CHECK_THROWS_AS(point.add(1), std::logic_error);
  Json points = Json::array();
  CHECK_THROWS_AS(points.put("a", 1), std::logic_error);
  points.add(point);
  Json whole = Json::object();
  whole.put("special_points", points).put("branches", Json::array());
  CHECK(whole.text() == "{\n  \"special_points\": [\n    {\"type\": \"LP\", \"omega\": 1.25, \"bracket\": [1, 2]}\n  ],\n  \"branches\": []\n}\n");
}
