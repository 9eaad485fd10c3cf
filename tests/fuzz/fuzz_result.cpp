/// A result file of any bytes, read within this process (the program reads apart: what the HDF5 library does with a damaged file is not ours).
/// Mutations below the checksums of the file's structure: each is signed again.

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "studies/configuration.hpp"
#include "studies/hdf5_format.hpp"
#include "studies/open_results.hpp"

using namespace whirl::studies;

#ifdef WHIRL_FUZZ
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

void sign(std::uint8_t* data, std::size_t begin, std::size_t length) {
  const std::uint32_t sum = hdf5_format::checksum({reinterpret_cast<const char*>(data) + begin, length});
  for (int i = 0; i < 4; ++i) data[begin + length + i] = static_cast<std::uint8_t>(sum >> (8 * i));
}

std::uint32_t word(const std::uint8_t* data) {
  std::uint32_t w = 0;
  for (int i = 0; i < 4; ++i) w |= std::uint32_t{data[i]} << (8 * i);
  return w;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned) {
  constexpr std::size_t head = 10, sum = 4;  // of an object header: "OHDR", version, flags, four bytes of size
  size = LLVMFuzzerMutate(data, size, max_size);
  if (size >= hdf5_format::superblock_size) sign(data, 0, hdf5_format::superblock_size - sum);
  const std::string_view signature = "OHDR", all(reinterpret_cast<const char*>(data), size);
  for (std::size_t at = all.find(signature); at != all.npos; at = all.find(signature, at + 1)) {
    const std::size_t room = size - at;
    if (room < head + sum) break;
    const std::size_t length = head + word(data + at + 6);
    if (length + sum <= room) sign(data, at, length);
  }
  return size;
}

#endif

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("result", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (::ftruncate(file, 0) != 0 || ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) return -1;
  try {
    read_all(path);
  } catch (const InputError&) {
  } catch (const std::runtime_error&) {  // "damaged", where the file is read apart
  }
  return 0;
}
