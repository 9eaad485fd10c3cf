// The program `whirl`: command line only; everything it does lives in the library beside it.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/memory.hpp"
#include "studies/apart.hpp"
#include "studies/export.hpp"
#include "studies/interruption.hpp"
#include "studies/json_tables.hpp"
#include "studies/modes_study.hpp"
#include "studies/open_results.hpp"
#include "studies/registry.hpp"
#include "studies/result_file.hpp"
#include "studies/result_place.hpp"
#include "studies/standard_streams.hpp"

using namespace whirl::studies;
namespace fs = std::filesystem;

namespace {

/// The text as one line of at most 440 characters, however long the input's names are: what is too long loses its middle, since place and key stand
/// first and what is wanted last.
std::string brief(std::string_view text) {
  constexpr std::size_t longest = 440, tail = 160;
  std::string s;
  for (const char c : text) {
    const bool space = static_cast<unsigned char>(c) <= 0x20 || c == 0x7f;
    if (!space || (!s.empty() && s.back() != ' ')) s += space ? ' ' : c;
  }
  if (s.size() <= longest) return s;
  const auto inside_character = [&](std::size_t at) { return (static_cast<unsigned char>(s[at]) & 0xc0) == 0x80; };  // of UTF-8
  std::size_t end = longest - tail - 5, from = s.size() - tail;
  while (end > 0 && inside_character(end)) --end;
  while (from < s.size() && inside_character(from)) ++from;
  return s.substr(0, end) + " ... " + s.substr(from);
}

Configuration read(const std::string& file, const std::vector<std::string>& overrides) {
  return Configuration::from_file(file, schemas(), overrides);
}

ExitStatus run(const std::string& file, const std::vector<std::string>& overrides, const std::string& output, bool json, bool quiet) {
  const Configuration configuration = read(file, overrides);
  RunContext context;
  context.output = output.empty() ? fs::path(file).stem().concat(".h5") : fs::path(output);
  context.json = json;
  context.quiet = quiet;
  const StudyKind& kind = study_kind(configuration.kind());
  if (kind.check) (void)kind.check(configuration);  // bad input before anything is written
  std::error_code ignored;
  if (fs::equivalent(context.output, file, ignored)) throw InputError(fmt::format("{}: is the study file itself, not a place for results", file));
  ResultFile::check_writable(context.output);
  check_result_place(context.output);
  catch_interrupts_of_run(quiet);
  ExitStatus status;
  context.report.put("kind", configuration.kind());
  try {
    status = kind.run(configuration, context);
  } catch (const std::exception& e) {
    ResultFile::mark_failed(context.output, e.what());
    throw;
  }
  for (const char* key : {"special_points", "branches"})  // in the report of every kind
    if (!context.report.has(key)) context.report.put(key, Json::array());
  if (json) {
    if (!context.report.has("tables")) context.report.put("tables", tables_json(context.output));
    fmt::print("{}", context.report.text());
  }
  if (!quiet) fmt::print(stderr, "{}result: {}\n", interrupted ? "interrupted; " : "", context.output.string());
  return status;
}

ExitStatus check(const std::string& file, const std::vector<std::string>& overrides) {
  const Configuration configuration = read(file, overrides);
  const StudyKind& kind = study_kind(configuration.kind());
  if (kind.check)
    for (const auto& w : kind.check(configuration)) fmt::print(stderr, "warning: {}\n", w);
  fmt::print("{}: a valid {} study\n", file, configuration.kind());
  return ExitStatus::ok;
}

/// Reads all before anything is written.
std::vector<std::string> exported(const std::string& file, const std::string& folder) {
  return in_process_of_its_own(file, [&] {
    read_all(file);
    std::vector<std::string> files;
    for (const auto& written : export_csv(file, folder)) files.push_back(written.string());
    return files;
  });
}

// A line that helps where the first word is missing or no command: a misspelt one, or a study file without `run` before it.
void check_first_word(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (argc < 2) throw InputError(fmt::format("a command is needed: {}; see whirl --help", fmt::join(names, ", ")));
  const std::string word = argv[1];
  if (word.starts_with("-") || std::find(names.begin(), names.end(), word) != names.end()) return;
  std::error_code ignored;
  const std::string near = fs::is_regular_file(word, ignored) || word.ends_with(".toml") ? "run " + word : nearest(word, names);
  throw InputError(near.empty() ? fmt::format("no command '{}': one of {}; see whirl --help", word, fmt::join(names, ", "))
                                : fmt::format("no command '{}', did you mean `whirl {}`? see whirl --help", word, near));
}

// What `whirl help COMMAND` prints; of the whole program without a name.
std::string help_text(const CLI::App& app, const std::string& name) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    names.push_back(command->get_name());
    if (names.back() == name) return command->help("whirl " + name);
  }
  if (name.empty()) return app.help();
  const std::string near = nearest(name, names);
  throw InputError(fmt::format("no command '{}'{}", name,
                               near.empty() ? fmt::format(": one of {}", fmt::join(names, ", ")) : fmt::format(", did you mean '{}'?", near)));
}

}  // namespace

int main(int argc, char** argv) {
  secure_standard_streams();
  whirl::keep_freed_memory();
  CLI::App app{"Whirl: nonlinear response of cables by continuation, averaging and time integration"};
  app.set_version_flag("-V,--version", version_text());
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& e) { return fmt::format("error: {}; see whirl --help\n", brief(e.what())); });
  std::string file, output, kind;
  std::vector<std::string> overrides;
  bool json = false, quiet = false;

  auto* run_command = app.add_subcommand("run", "run a study file");
  run_command->add_option("FILE", file, "study file (TOML)")->required();
  run_command->add_option("--set", overrides, "override a key: section.key=value (repeatable)")->allow_extra_args(false);
  run_command->add_option("-o,--output", output, "result file; default: the study's name with .h5, in this folder");
  run_command->add_flag("--json", json, "results as JSON on standard output, tables on standard error");
  run_command->add_flag("-q,--quiet", quiet, "no tables");
  auto* check_command = app.add_subcommand("check", "read and check a study file, compute nothing");
  check_command->add_option("FILE", file, "study file (TOML)")->required();
  check_command->add_option("--set", overrides, "override a key: section.key=value (repeatable)")->allow_extra_args(false);
  auto* modes_command = app.add_subcommand("modes", "frequencies, shapes' numbers and resonances of a study file's cable, as a table");
  modes_command->add_option("FILE", file, "study file (TOML) with a [cable]")->required();
  modes_command->add_option("--set", overrides, "override a key: section.key=value (repeatable)")->allow_extra_args(false);
  auto* init_command = app.add_subcommand("init", "print a commented study file");
  init_command->add_option("KIND", kind, "study kind, see `whirl list`")->required();
  auto* list_command = app.add_subcommand("list", "study kinds");
  auto* export_command = app.add_subcommand("export", "tables of a result file as CSV, one file per branch");
  export_command->add_option("FILE", file, "result file (HDF5)")->required();
  export_command->add_option("-o,--output", output, "folder; default: <result>-csv beside the file");
  std::string subject;
  auto* help_command = app.add_subcommand("help", "explain the program, or one of its commands");
  help_command->add_option("COMMAND", subject, "command");
  auto* version_command = app.add_subcommand("version", "version and libraries");

  ExitStatus status = ExitStatus::ok;
  try {
    check_first_word(app, argc, argv);
    app.parse(argc, argv);
    if (help_command->parsed()) {
      app.clear();  // else its help is that of the command given, which is `help`
      fmt::print("{}", help_text(app, subject));
    }
    if (version_command->parsed()) fmt::print("{}\n", version_text());
    if (run_command->parsed()) status = run(file, overrides, output, json, quiet);
    if (check_command->parsed()) status = check(file, overrides);
    if (modes_command->parsed()) fmt::print("{}", modes_table(read(file, overrides)));
    if (init_command->parsed()) fmt::print("{}", example_toml(study_kind(kind).schema));
    if (list_command->parsed())
      for (const auto& k : study_kinds()) fmt::print("{:<16} {}\n", k.schema.kind(), k.schema.summary());
    if (export_command->parsed())
      for (const auto& written : exported(file, output)) fmt::print("{}\n", written);
  } catch (const CLI::ParseError& e) {
    if (app.exit(e) != 0) status = ExitStatus::bad_input;
  } catch (const InputError& e) {
    fmt::print(stderr, "error: {}\n", brief(e.what()));
    status = ExitStatus::bad_input;
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", brief(e.what()));
    status = ExitStatus::numerical_failure;
  }
  if (const auto lost = lost_output(); lost && status == ExitStatus::ok) {
    fmt::print(stderr, "error: {}\n", *lost);
    status = ExitStatus::numerical_failure;
  }
  return static_cast<int>(status);
}
