#pragma once
/// Work on a file that may be damaged, in a process of its own: what crashes or never ends there is one line here.
///
///     const auto files = in_process_of_its_own(result, [&] { return export_csv(result); });

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace whirl::studies {

/// The lines that `work` returns. Throws InputError "<file>: is damaged" if it crashes, takes longer than a file of this size can take, or throws
/// anything but an InputError, which arrives as it was. Before other threads are started only.
std::vector<std::string> in_process_of_its_own(const std::filesystem::path& file, const std::function<std::vector<std::string>()>& work);

}  // namespace whirl::studies
