#include "studies/result_place.hpp"

#include <fmt/format.h>

#include "studies/apart.hpp"
#include "studies/configuration.hpp"
#include "studies/result_file.hpp"

namespace whirl::studies {

namespace fs = std::filesystem;

namespace {

// Read apart, for it may be damaged.
bool is_result(const fs::path& path) try {
  (void)in_process_of_its_own(path, [&] { return std::vector{ResultReader(path).text_attribute("/study", "kind")}; });
  return true;
} catch (const InputError&) {
  return false;
}

}  // namespace

void check_result_place(const fs::path& path) {
  std::error_code failure;
  if (const auto size = fs::file_size(path, failure); !failure && size > 0) {
    if (is_result(path)) return;
    throw InputError(fmt::format("{}: exists and is no result of whirl: choose another name with -o, or remove it", path.string()));
  }
  const std::string extension = path.extension().string();
  if (extension.empty() || extension == ".h5" || extension == ".hdf5") return;
  throw InputError(fmt::format("{}: a result is an HDF5 file: give it a name that ends in .h5{}", path.string(),
                               extension == ".csv" ? "; `whirl export` makes CSV of it" : ""));
}

}  // namespace whirl::studies
