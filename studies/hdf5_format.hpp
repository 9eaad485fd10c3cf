#pragma once
/// The parts of an HDF5 file as bytes, as far as result files need them: groups with compact links, contiguous 1-D columns and scalars of doubles and
/// of UTF-8 texts, attributes. Written after the HDF5 File Format Specification, version 3.0 (superblock 2, object headers 2), so that any HDF5 of
/// 1.8 or later reads it.
///
/// Why not with the HDF5 library: it changes parts in place (headers, heaps, the superblock) in an order of its own, so a run killed inside a flush
/// leaves a file that nothing opens. A part made here is never changed once it is written: a new state is appended, and made valid by the 48 bytes of
/// the superblock.
///
///     Bytes header = object_header({dataspace({3}), float_type(), fill_value(), contiguous(address, 24)});

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace whirl::studies::hdf5_format {

using Bytes = std::string;

constexpr std::uint64_t undefined_address = ~std::uint64_t{0};
constexpr std::size_t superblock_size = 48;
constexpr std::size_t text_reference_size = 16;    ///< of a text in a dataset or attribute: its length and where it lies in a heap
constexpr std::size_t largest_message = 65535;     ///< of an object header: attributes beyond this need another storage
constexpr std::size_t smallest_heap = 4096;        ///< the library refuses smaller ones
constexpr std::size_t most_texts_in_heap = 65535;  ///< their numbers have 16 bits

void append_number(Bytes& into, std::uint64_t value, int bytes);  ///< little-endian

/// Bob Jenkins' lookup3, the checksum of every part of the file's structure.
std::uint32_t checksum(std::string_view bytes);

Bytes superblock(std::uint64_t end_of_file, std::uint64_t root);

struct Message {
  std::uint8_t type;
  Bytes data;
};
/// Throws std::length_error if a message is larger than largest_message.
Bytes object_header(const std::vector<Message>& messages);

Message dataspace(std::optional<std::uint64_t> rows);  ///< a scalar without rows
Message float_type();                                  ///< IEEE double, little-endian
Message text_type();                                   ///< UTF-8 of any length
Message fill_value();
Message contiguous(std::uint64_t address, std::uint64_t bytes);
Message attribute(std::string_view name, const Message& type, const Message& space, std::string_view data);
Message link_info(std::uint64_t next_order);  ///< members remember the order in which they were created
Message group_info();
Message hard_link(std::string_view name, std::uint64_t order, std::uint64_t address);

Bytes text_reference(std::size_t length, std::uint64_t heap, std::uint32_t number);
Bytes heap_head(std::uint64_t size);                             ///< 16 bytes
Bytes heap_object(std::uint32_t number, std::string_view text);  ///< padded to 8
Bytes heap_rest(std::uint64_t free);                             ///< what fills the heap: the free space, itself included; 16 bytes at least

}  // namespace whirl::studies::hdf5_format
