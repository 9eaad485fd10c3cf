/// A study file of any bytes: read and checked as `whirl check` does it. Whatever is wrong is told by an InputError; nothing else may leave.

#include <cstdint>
#include <string_view>

#include "studies/configuration.hpp"
#include "studies/registry.hpp"

using namespace whirl::studies;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<Schema> all = schemas();
  try {
    const Configuration c = Configuration::from_text({reinterpret_cast<const char*>(data), size}, "study.toml", all);
    (void)Configuration::from_text(c.resolved_toml(), "resolved.toml", all);  // what a result file tells can be run again
    if (const StudyKind& kind = study_kind(c.kind()); kind.check) (void)kind.check(c);
  } catch (const InputError&) {
  }
  return 0;
}
