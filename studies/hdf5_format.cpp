#include "studies/hdf5_format.hpp"

#include <fmt/format.h>

#include <bit>
#include <stdexcept>

namespace whirl::studies::hdf5_format {
namespace {

// Types of header messages, section IV.A.2 of the specification.
enum MessageType : std::uint8_t {
  dataspace_message = 0x01,
  link_info_message = 0x02,
  datatype_message = 0x03,
  fill_value_message = 0x05,
  link_message = 0x06,
  layout_message = 0x08,
  group_info_message = 0x0a,
  attribute_message = 0x0c,
};

constexpr int address_bytes = 8;

Bytes numbers(std::initializer_list<unsigned> bytes) {
  Bytes all;
  for (const unsigned b : bytes) all += static_cast<char>(b);
  return all;
}

void append_checksum(Bytes& part) { append_number(part, checksum(part), 4); }

}  // namespace

void append_number(Bytes& into, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) into += static_cast<char>(value >> (8 * i) & 0xff);
}

std::uint32_t checksum(std::string_view bytes) {
  const auto word = [&bytes](std::size_t at) {  // bytes beyond the end count as zero
    std::uint32_t w = 0;
    for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i) w |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return w;
  };
  std::uint32_t a = 0xdeadbeef + static_cast<std::uint32_t>(bytes.size()), b = a, c = a;
  const auto mix = [](std::uint32_t& x, std::uint32_t& y, std::uint32_t& z, int turn) {
    x -= z;
    x ^= std::rotl(z, turn);
    z += y;
  };
  const auto end = [](std::uint32_t& x, std::uint32_t y, int turn) {
    x ^= y;
    x -= std::rotl(y, turn);
  };
  std::size_t at = 0;
  for (; bytes.size() - at > 12; at += 12) {
    a += word(at), b += word(at + 4), c += word(at + 8);
    mix(a, b, c, 4), mix(b, c, a, 6), mix(c, a, b, 8), mix(a, b, c, 16), mix(b, c, a, 19), mix(c, a, b, 4);
  }
  if (at == bytes.size()) return c;
  a += word(at), b += word(at + 4), c += word(at + 8);
  end(c, b, 14), end(a, c, 11), end(b, a, 25), end(c, b, 16), end(a, c, 4), end(b, a, 14), end(c, b, 24);
  return c;
}

Bytes superblock(std::uint64_t end_of_file, std::uint64_t root) {
  Bytes b = "\x89HDF\r\n\x1a\n";
  b += numbers({2, address_bytes, address_bytes, 0});
  for (const std::uint64_t address : {std::uint64_t{0}, undefined_address, end_of_file, root}) append_number(b, address, address_bytes);
  append_checksum(b);
  return b;
}

Bytes object_header(const std::vector<Message>& messages) {
  constexpr unsigned four_byte_size = 2;
  Bytes body;
  for (const Message& m : messages) {
    if (m.data.size() > largest_message) throw std::length_error(fmt::format("a header message of {} bytes", m.data.size()));
    body += static_cast<char>(m.type);
    append_number(body, m.data.size(), 2);
    body += '\0';
    body += m.data;
  }
  Bytes header = "OHDR" + numbers({2, four_byte_size});
  append_number(header, body.size(), 4);
  header += body;
  append_checksum(header);
  return header;
}

Message dataspace(std::optional<std::uint64_t> rows) {
  Bytes b = rows ? numbers({2, 1, 0, 1}) : numbers({2, 0, 0, 0});  // version, rank, no largest size, simple or scalar
  if (rows) append_number(b, *rows, 8);
  return {dataspace_message, b};
}

Message float_type() {
  // Class 1 (floating point), leading 1 implied, sign in bit 63; 8 bytes; 64 bits from bit 0, exponent 11 bits from 52, mantissa 52 from 0, bias
  // 1023.
  return {datatype_message, numbers({0x11, 0x20, 0x3f, 0, 8, 0, 0, 0, 0, 0, 64, 0, 52, 11, 0, 52, 0xff, 0x03, 0, 0})};
}

Message text_type() {
  // Class 9 (variable length), a string, ended by zero, UTF-8; 16 bytes; of unsigned bytes.
  return {datatype_message, numbers({0x19, 0x01, 0x01, 0, 16, 0, 0, 0, 0x10, 0, 0, 0, 1, 0, 0, 0, 0, 0, 8, 0})};
}

Message fill_value() { return {fill_value_message, numbers({3, 0x0a})}; }  // allocated late, written if set; none is

Message contiguous(std::uint64_t address, std::uint64_t bytes) {
  Bytes b = numbers({3, 1});
  append_number(b, bytes > 0 ? address : undefined_address, address_bytes);
  append_number(b, bytes, 8);
  return {layout_message, b};
}

Message attribute(std::string_view name, const Message& type, const Message& space, std::string_view data) {
  constexpr unsigned utf8 = 1;
  Bytes b = numbers({3, 0});
  append_number(b, name.size() + 1, 2);
  append_number(b, type.data.size(), 2);
  append_number(b, space.data.size(), 2);
  b += numbers({utf8});
  b += name;
  b += '\0';
  b += type.data + space.data;
  b += data;
  return {attribute_message, b};
}

Message link_info(std::uint64_t next_order) {
  constexpr unsigned order_tracked_and_indexed = 3;
  Bytes b = numbers({0, order_tracked_and_indexed});
  append_number(b, next_order, 8);
  for (int i = 0; i < 3; ++i) append_number(b, undefined_address, address_bytes);  // no heap, no trees: the links stand in the header
  return {link_info_message, b};
}

Message group_info() { return {group_info_message, numbers({0, 0})}; }

Message hard_link(std::string_view name, std::uint64_t order, std::uint64_t address) {
  constexpr unsigned four_byte_name_size = 2, has_order = 4, has_character_set = 16, utf8 = 1;
  Bytes b = numbers({1, four_byte_name_size | has_order | has_character_set});
  append_number(b, order, 8);
  b += numbers({utf8});
  append_number(b, name.size(), 4);
  b += name;
  append_number(b, address, address_bytes);
  return {link_message, b};
}

Bytes text_reference(std::size_t length, std::uint64_t heap, std::uint32_t number) {
  Bytes b;
  append_number(b, length, 4);
  append_number(b, heap, address_bytes);
  append_number(b, number, 4);
  return b;
}

Bytes heap_head(std::uint64_t size) {
  Bytes b = "GCOL" + numbers({1, 0, 0, 0});
  append_number(b, size, 8);
  return b;
}

Bytes heap_object(std::uint32_t number, std::string_view text) {
  Bytes b;
  append_number(b, number, 2);
  append_number(b, 1, 2);  // references to it
  append_number(b, 0, 4);
  append_number(b, text.size(), 8);
  b += text;
  b.resize((b.size() + 7) / 8 * 8);
  return b;
}

Bytes heap_rest(std::uint64_t free) {
  Bytes b;
  append_number(b, 0, 8);  // number 0: what is free
  append_number(b, free, 8);
  b.resize(free);
  return b;
}

}  // namespace whirl::studies::hdf5_format
