/// The result file: what is written reads back, a killed run leaves a readable file, bad places and damaged files give one clear line.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>
#include <random>

#include "studies/apart.hpp"
#include "studies/configuration.hpp"
#include "studies/export.hpp"
#include "studies/open_results.hpp"
#include "studies/result_file.hpp"
#include "tests/studies/program.hpp"
#include "tests/studies/refusal.hpp"

using namespace whirl::studies;
using namespace whirl::studies::tests;
namespace fs = std::filesystem;

namespace {

std::string refusal_to_read(const fs::path& path) {
  return message([&] { ResultReader reader(path); });
}
std::string refusal_to_write(const fs::path& path) {
  const std::string early = message([&] { ResultFile::check_writable(path); });
  CHECK(early == message([&] { ResultFile file(path); }));
  return early;
}

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<Column> branch(std::size_t rows) {
  std::vector<Column> columns{{"omega", "rad/s", "excitation frequency", {}}, {"amplitude", "m", "amplitude of q1", {}}};
  for (std::size_t i = 0; i < rows; ++i) {
    columns[0].values.push_back(1.0 / (1.0 + static_cast<double>(i)));
    columns[1].values.push_back(-1e-300 * static_cast<double>(i));
  }
  return columns;
}

void write_example(const fs::path& path) {
  ResultFile file(path);
  file.attribute("/study", "kind", "superharmonic");
  file.attribute("/study", "tolerance", 1e-10);
  file.attribute("/study", "warnings", std::vector<std::string>{"first", "second: \u03c9"});
  file.attribute("/study", "none", std::vector<std::string>{});
  file.attribute("/study", "range", std::vector<double>{1.0, 2.5});
  file.text("/study", "configuration", "a = 1\n");
  file.scalar("/cable", "sag_ratio", 0.01, "-", "sag over span");
  file.table("/branches/IP1", branch(3), {{"type", "special point", {"LP", "BP, \"WH\"", ""}}});
  file.table("/branches/OP1", branch(0), {{"type", "special point", {}}});
}

}  // namespace

TEST_CASE("a result file reads back what was written", "[result_file]") {
  const Folder folder;
  write_example(folder / "r.h5");
  const ResultReader reader(folder / "r.h5");
  CHECK(reader.tables() == std::vector<std::string>{"/branches/IP1", "/branches/OP1"});
  CHECK(reader.column_names("/branches/IP1") == std::vector<std::string>{"omega", "amplitude", "type"});
  const Table table = reader.table("/branches/IP1");
  REQUIRE(table.columns.size() == 2);
  CHECK(table.columns[0].name == "omega");
  CHECK(table.columns[0].unit == "rad/s");
  CHECK(table.columns[0].description == "excitation frequency");
  CHECK(table.columns[0].values == branch(3)[0].values);
  CHECK(table.columns[1].values == branch(3)[1].values);
  REQUIRE(table.text_columns.size() == 1);
  CHECK(table.text_columns[0].values == std::vector<std::string>{"LP", "BP, \"WH\"", ""});
  CHECK(reader.table("/branches/OP1").columns[0].values.empty());
  CHECK(reader.table("/branches/OP1").text_columns[0].values.empty());
  CHECK(reader.text_attribute("/study", "kind") == "superharmonic");
  CHECK(reader.number_attribute("/study", "tolerance") == 1e-10);
  CHECK(reader.texts_attribute("/study", "warnings") == std::vector<std::string>{"first", "second: \u03c9"});
  CHECK(reader.texts_attribute("/study", "none").empty());
  CHECK(reader.numbers_attribute("/study", "range") == std::vector<double>{1.0, 2.5});
  CHECK(reader.attribute_names("/study") == std::vector<std::string>{"kind", "none", "range", "tolerance", "warnings"});
  CHECK(reader.text("/study", "configuration") == "a = 1\n");
  CHECK(reader.scalar("/cable", "sag_ratio").value == 0.01);
  CHECK(reader.scalar("/cable", "sag_ratio").unit == "-");
  CHECK(reader.children("/") == std::vector<std::string>{"study", "cable", "branches"});
  CHECK(reader.has("/branches/IP1/omega"));
  CHECK_FALSE(reader.has("/branches/IP2"));
  const std::string name = (folder / "r.h5").string();
  CHECK(message([&] { reader.table("/branches/IP2"); }) == name + ": has no group /branches/IP2");
  CHECK(message([&] { reader.column("/branches/IP1", "tension"); }) == name + ": has no column /branches/IP1/tension");
  CHECK(message([&] { reader.column("/branches/IP1", "type"); }) == name + ": /branches/IP1/type is not a column of numbers");
  CHECK(message([&] { reader.text_column("/branches/IP1", "omega"); }) == name + ": /branches/IP1/omega is not a column of texts");
  CHECK(message([&] { reader.number_attribute("/study", "kind"); }) == name + ": /study has no attribute kind of numbers");
  CHECK(message([&] { reader.text_attribute("/nowhere", "kind"); }) == name + ": has no /nowhere");
}

TEST_CASE("what is written again is replaced", "[result_file]") {
  const Folder folder;
  {
    ResultFile file(folder / "r.h5");
    for (std::size_t rows : {5u, 2u, 700u}) {
      file.table("/branches/IP1", branch(rows), {{"type", "", std::vector<std::string>(rows, "LP")}});
      file.attribute("/branches/IP1", "stop_reason", rows == 700u ? "range_end" : "running");
      file.attribute("/branches/IP1", "points", static_cast<double>(rows));
    }
    CHECK_THROWS_AS(file.table("/x", {{"a", "", "", {1.0}}, {"b", "", "", {}}}), std::invalid_argument);
    CHECK_THROWS_AS(file.table("/x", {{"a/b", "", "", {1.0}}}), std::invalid_argument);
  }
  const ResultReader reader(folder / "r.h5");
  CHECK(reader.column("/branches/IP1", "omega").values == branch(700)[0].values);
  CHECK(reader.text_column("/branches/IP1", "type").values.size() == 700);
  CHECK(reader.text_attribute("/branches/IP1", "stop_reason") == "range_end");
}

TEST_CASE("places where no result can be written", "[result_file]") {
  const Folder folder;
  CHECK(refusal_to_write(folder.path) == folder.path.string() + ": is a directory, not a result file");
  const fs::path nowhere = folder / "no/such/r.h5";
  CHECK(refusal_to_write(nowhere) == nowhere.string() + ": folder " + nowhere.parent_path().string() + " does not exist");
  CHECK(refusal_to_write("/dev/null") == "/dev/null: is not a regular file");
  CHECK(refusal_to_write("/dev/null/r.h5") == "/dev/null/r.h5: /dev/null is not a folder");
  CHECK(refusal_to_write("") == "the result file has no name");
  CHECK(message([] { ResultFile file("/proc/r.h5"); }).starts_with("/proc/r.h5: "));

  ResultFile::check_writable(folder / "new.h5");
  CHECK_FALSE(fs::exists(folder / "new.h5"));
  std::ofstream(folder / "old.h5") << "kept";
  ResultFile::check_writable(folder / "old.h5");
  CHECK(contents(folder / "old.h5") == "kept");

  fs::permissions(folder / "old.h5", fs::perms::owner_read);
  if (::geteuid() != 0) CHECK(refusal_to_write(folder / "old.h5") == (folder / "old.h5").string() + ": is not writable");
}

TEST_CASE("files that are no result", "[result_file]") {
  const Folder folder;
  const std::string name = (folder / "r.h5").string();
  CHECK(refusal_to_read(name) == name + ": no such file");
  CHECK(refusal_to_read(folder.path) == folder.path.string() + ": is a directory, not a result file");
  std::ofstream(name) << "study = 1\n";
  CHECK(refusal_to_read(name) == name + ": is not an HDF5 file");
  std::ofstream(name, std::ios::trunc).close();
  CHECK(refusal_to_read(name) == name + ": is not an HDF5 file");
  write_example(name);
  const auto size = fs::file_size(name);
  for (const auto left : {size - 1, size / 2, size / 4, std::uintmax_t{200}}) {
    write_example(name);
    fs::resize_file(name, left);
    CHECK(refusal_to_read(name) == name + ": is truncated or damaged");
  }
}

TEST_CASE("a killed run leaves what was flushed", "[result_file]") {
  const Folder folder;
  const fs::path path = folder / "r.h5";
  const auto name = [](int i) { return "/branches/B" + std::to_string(i); };
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {  // the run: killed with branches 100..399 written but not flushed
    ResultFile file(path);
    for (int i = 0; i < 400; ++i) {
      file.table(name(i), branch(600), {{"type", "", std::vector<std::string>(600, "LP")}});
      if (i == 99) file.flush();
    }
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(WIFSIGNALED(status));
  const ResultReader reader(path);
  REQUIRE(reader.tables().size() == 100);
  for (int i = 0; i < 100; ++i) CHECK(reader.column(name(i), "amplitude").values == branch(600)[1].values);
}

TEST_CASE("a full disk leaves what was flushed", "[result_file]") {
  const Folder folder;
  const fs::path path = folder / "r.h5";
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {  // no file may grow beyond 200 kB here
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200000, 200000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    int written = 0;
    try {
      ResultFile file(path);
      file.attribute("/study", "outcome", std::string(ResultFile::unfinished));
      for (; written < 100; ++written) {
        file.table("/branches/B" + std::to_string(written), branch(2000));
        file.flush();
      }
    } catch (const std::runtime_error& e) {
      const bool clear = std::string(e.what()).starts_with(path.string() + ": writing ");
      ResultFile::mark_failed(path, e.what());
      ::_exit(clear ? written : 101);
    }
    ::_exit(102);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(WIFEXITED(status));
  REQUIRE(WEXITSTATUS(status) > 1);
  REQUIRE(WEXITSTATUS(status) < 100);
  const ResultReader reader(path);
  CHECK(reader.tables().size() == static_cast<std::size_t>(WEXITSTATUS(status)));
  CHECK(reader.text_attribute("/study", "outcome") == "failed");
  CHECK(reader.text_attribute("/study", "stop_reasons").starts_with(path.string() + ": writing failed"));
  CHECK(reader.column("/branches/B0", "omega").values == branch(2000)[0].values);
}

TEST_CASE("a result that grows can be read, and no second run may have its path", "[result_file]") {
  const Folder folder;
  const fs::path path = folder / "r.h5";
  ResultFile file(path);
  file.attribute("/study", "outcome", std::string(ResultFile::unfinished));
  CHECK(refusal_to_write(path) == path.string() + ": is being written by another program");  // not at its path yet
  for (int i = 1; i <= 3; ++i) {
    file.table("/branches/B" + std::to_string(i), branch(30));
    file.flush();
    CHECK(ResultReader(path).tables().size() == static_cast<std::size_t>(i));
  }
  CHECK(refusal_to_write(path) == path.string() + ": is being written by another program");
}

TEST_CASE("an older result stays until the run has a table", "[result_file]") {
  const Folder folder;
  const fs::path path = folder / "r.h5";
  write_example(path);
  const std::string old = contents(path);
  {
    ResultFile file(path);
    file.attribute("/study", "outcome", std::string(ResultFile::unfinished));
    file.flush();
    CHECK(contents(path) == old);
    CHECK_FALSE(published(file));
    SECTION("the first table replaces it") {
      file.table("/branches/B", branch(3));
      CHECK(contents(path) == old);
      file.flush();
      CHECK(published(file));
      CHECK(ResultReader(path).tables() == std::vector<std::string>{"/branches/B"});
    }
    SECTION("a run interrupted before leaves it") {
      file.attribute("/study", "outcome", std::string(interrupted_outcome));
      file.flush();
      CHECK(contents(path) == old);
    }
  }
  CHECK_FALSE(fs::exists(path.string() + ".unfinished"));
}

TEST_CASE("a symbolic link stays, its target is replaced, and what a killed run left is taken over", "[result_file]") {
  const Folder folder;
  fs::create_directory(folder / "elsewhere");
  fs::create_symlink("elsewhere/r.h5", folder / "link.h5");
  std::ofstream(folder / "elsewhere/r.h5.unfinished") << "left by a killed run";
  for (int i = 0; i < 2; ++i) {  // the target is missing, then there
    write_example(folder / "link.h5");
    CHECK(fs::is_symlink(folder / "link.h5"));
    CHECK(fs::is_regular_file(folder / "elsewhere/r.h5"));
    CHECK(ResultReader(folder / "link.h5").tables().size() == 2);
    CHECK_FALSE(fs::exists(folder / "elsewhere/r.h5.unfinished"));
  }
  fs::create_directory(folder / "x.h5.unfinished");
  CHECK(refusal_to_write(folder / "x.h5").ends_with("x.h5.unfinished stands in the way"));
}

TEST_CASE("a table that is extended reads as one written at once", "[result_file]") {
  const Folder folder;
  ResultFile file(folder / "r.h5");
  std::vector<double> all;
  std::vector<std::string> texts;
  for (int i = 0; i < 200; ++i) {
    std::vector<double> rows;
    for (int k = 0; k < i % 7; ++k) rows.push_back(100.0 * i + k);
    const std::vector<std::string> names(rows.size(), "B" + std::to_string(i));
    extend_table(file, "/special_points", {{"omega", "rad/s", "place", rows}}, {{"branch", "its name", names}});
    all.insert(all.end(), rows.begin(), rows.end());
    texts.insert(texts.end(), names.begin(), names.end());
    file.flush();
    if (i % 50 != 49) continue;
    const ResultReader reader(folder / "r.h5");
    CHECK(reader.column("/special_points", "omega").values == all);
    CHECK(reader.text_column("/special_points", "branch").values == texts);
    CHECK(reader.column("/special_points", "omega").unit == "rad/s");
  }
  CHECK_THROWS_WITH(extend_table(file, "/twice", {{"frequency", "Hz", "", {1.0}}, {"frequency", "rad/s", "", {2.0}}}),
                    "table /twice: two columns of one name");
  file.table("/special_points", {{"omega", "rad/s", "place", {1.0}}}, {{"branch", "its name", {"B"}}});
  extend_table(file, "/special_points", {{"omega", "rad/s", "place", {2.0}}}, {{"branch", "its name", {"C"}}});
  file.flush();
  CHECK(ResultReader(folder / "r.h5").column("/special_points", "omega").values.back() == 2.0);
}

TEST_CASE("hundreds of flushes cost what is new", "[result_file]") {
  const Folder folder;
  const auto size_with = [&](int branches) {
    ResultFile file(folder / "r.h5");
    for (int i = 0; i < branches; ++i) {
      file.table("/branches/B" + std::to_string(i), branch(300));
      extend_table(file, "/special_points", branch(4));
      file.flush();
    }
    return static_cast<double>(fs::file_size(folder / "r.h5"));
  };
  const double few = size_with(125), many = size_with(500);
  CHECK(many < 6.0 * few);  // four times the data and a list of names that is written anew each time
  CHECK(ResultReader(folder / "r.h5").tables().size() == 501);
}

TEST_CASE("a list longer than an attribute can be is kept as a column", "[result_file]") {
  const Folder folder;
  const std::vector<double> numbers(20000, 0.5);
  {
    ResultFile file(folder / "r.h5");
    file.attribute("/study", "stiffness.at", numbers);
  }
  CHECK(ResultReader(folder / "r.h5").column("/study", "stiffness.at").values == numbers);
}

TEST_CASE("a result that a reader holds open is refused and stays as it is", "[result_file]") {
  const Folder folder;
  write_example(folder / "r.h5");
  const auto size = fs::file_size(folder / "r.h5");
  {
    const ResultReader held(folder / "r.h5");
    CHECK(refusal_to_write(folder / "r.h5") == (folder / "r.h5").string() + ": is open in another program");
    CHECK_THROWS_AS(ResultFile(folder / "r.h5"), InputError);
  }
  CHECK(fs::file_size(folder / "r.h5") == size);
  CHECK(ResultReader(folder / "r.h5").tables().size() == 2);
  CHECK_NOTHROW(ResultFile::check_writable(folder / "r.h5"));
}

TEST_CASE("a run that ends by an exception tells so in its file", "[result_file]") {
  const Folder folder;
  for (const std::string outcome : {"unfinished", "complete"}) {
    {
      ResultFile file(folder / "r.h5");
      file.attribute("/study", "outcome", outcome);
      file.table("/branches/B0", branch(5));
    }
    ResultFile::mark_failed(folder / "r.h5", "no solution");
    const ResultReader reader(folder / "r.h5");
    CHECK(reader.text_attribute("/study", "outcome") == (outcome == "complete" ? "complete" : "failed"));
    if (outcome == "unfinished") CHECK(reader.text_attribute("/study", "stop_reasons") == "no solution");
    CHECK(reader.column("/branches/B0", "omega").values.size() == 5);
  }
  write_example(folder / "other.h5");  // without an outcome
  const auto size = fs::file_size(folder / "other.h5");
  ResultFile::mark_failed(folder / "other.h5", "nothing");
  CHECK(fs::file_size(folder / "other.h5") == size);
  const ResultFile held(folder / "held.h5");  // open still, as after a full disk
  ResultFile::mark_failed(folder / "held.h5", "nothing");
  ResultFile::mark_failed(folder / "none.h5", "nothing");
  CHECK_FALSE(fs::exists(folder / "none.h5"));
}

TEST_CASE("work in a process of its own: crashes and errors are one line", "[export]") {
  const Folder folder;
  write_example(folder / "r.h5");
  const std::string name = (folder / "r.h5").string();
  const auto apart = [&](auto work) { return message([&] { (void)in_process_of_its_own(name, work); }); };
  using Lines = std::vector<std::string>;
  CHECK(in_process_of_its_own(name, [] { return Lines{"a", "", "b"}; }) == Lines{"a", "", "b"});
  CHECK(apart([]() -> Lines { throw InputError("said so"); }) == "said so");
  CHECK(apart([]() -> Lines { throw std::runtime_error("reading failed"); }) == name + ": is damaged");
  CHECK(apart([]() -> Lines {
          ::raise(SIGKILL);
          return {};
        }) == name + ": is damaged");
}

TEST_CASE("files with any bytes changed are read or refused in one line", "[export]") {
  const Folder folder;
  write_example(folder / "r.h5");
  const std::string whole = contents(folder / "r.h5"), name = (folder / "m.h5").string();
  std::minstd_rand chance(7);
  for (int i = 0; i < 60; ++i) {
    std::string mutated = whole;
    for (std::size_t k = 0; k < 1 + chance() % 8; ++k) {
      std::size_t at = chance() % mutated.size();
      while (mutated[at] == 0) at = chance() % mutated.size();
      mutated[at] = static_cast<char>(chance());
    }
    std::ofstream(name, std::ios::binary) << mutated;
    const std::string refusal = message([&] {
      (void)in_process_of_its_own(name, [&] {
        read_all(name);
        return std::vector<std::string>{};
      });
    });
    CHECK((refusal == "accepted" || refusal.starts_with(name + ": ")));
  }
}

TEST_CASE("export writes one CSV file per table", "[export]") {
  const Folder folder;
  write_example(folder / "r.h5");
  const auto files = export_csv(folder / "r.h5");
  REQUIRE(files == std::vector<fs::path>{folder / "r-csv/branches-IP1.csv", folder / "r-csv/branches-OP1.csv",
                                         folder / "r-csv/study-configuration.txt", folder / "r-csv/cable.csv", folder / "r-csv/attributes.csv"});
  CHECK(contents(files[0]) ==
        "# omega [rad/s], amplitude [m], type\n"
        "omega,amplitude,type\n"
        "1,-0,LP\n"
        "0.5,-1e-300,\"BP, \"\"WH\"\"\"\n"
        "0.33333333333333331,-2.0000000000000001e-300,\n");
  CHECK(contents(files[1]) == "# omega [rad/s], amplitude [m], type\nomega,amplitude,type\n");
  CHECK(std::distance(fs::directory_iterator(folder / "r-csv"), fs::directory_iterator()) == 5);  // nothing half-written stays
  CHECK(export_csv(folder / "r.h5", folder / "deep/er")[0] == folder / "deep/er/branches-IP1.csv");
}

TEST_CASE("export to a place that cannot be written", "[export]") {
  const Folder folder;
  write_example(folder / "r.h5");
  std::ofstream(folder / "file") << "x";
  const std::string file = (folder / "file").string();
  CHECK(message([&] { export_csv(folder / "r.h5", file); }) == file + ": cannot be created as a folder");
  fs::create_directories(folder / "out/branches-IP1.csv");
  const std::string taken = (folder / "out/branches-IP1.csv").string();
  CHECK(message([&] { export_csv(folder / "r.h5", folder / "out"); }) == taken + ": cannot be written");
  CHECK_FALSE(fs::exists(taken + ".part"));
  CHECK(message([&] { export_csv(folder / "none.h5"); }) == (folder / "none.h5").string() + ": no such file");
}

TEST_CASE("non-finite numbers and several tables with alike names", "[export]") {
  const Folder folder;
  const double inf = std::numeric_limits<double>::infinity();
  {
    ResultFile file(folder / "r.h5");
    file.table("/a/b", {{"x", "", "", {inf, std::nan("")}}});
    file.table("/a-b", {{"x", "-", "", {-inf}}});
    file.table("/", {{"x", "-", "", {1.0}}});
  }
  const auto files = export_csv(folder / "r.h5");
  REQUIRE(files.size() == 4);  // the attributes last
  CHECK(files[0].filename() == "root.csv");
  CHECK(files[1].filename() == "a-b.csv");
  CHECK(files[2].filename() == "a-b-2.csv");
  CHECK(contents(files[1]) == "# x\nx\ninf\nnan\n");
}
