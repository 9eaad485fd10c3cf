/// Overrides, one a line, on what `whirl init` prints: the first byte chooses the kind. Read and checked as by `whirl check FILE --set ...`.

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "studies/configuration.hpp"
#include "studies/registry.hpp"

using namespace whirl::studies;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<Schema> all = schemas();
  if (size == 0) return -1;
  std::istringstream lines(std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  std::vector<std::string> overrides;
  for (std::string line; std::getline(lines, line);) overrides.push_back(line);
  const StudyKind& kind = study_kinds()[data[0] % study_kinds().size()];
  try {
    const Configuration c = Configuration::from_text(example_toml(kind.schema), "study.toml", all, overrides);
    if (const StudyKind& chosen = study_kind(c.kind()); chosen.check) (void)chosen.check(c);
  } catch (const InputError&) {
  }
  return 0;
}
