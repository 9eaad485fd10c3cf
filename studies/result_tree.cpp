#include "studies/result_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace whirl::studies {
namespace {

using namespace hdf5_format;

Bytes raw(const double* values, std::size_t count) {
  Bytes b(count * sizeof(double), '\0');
  if (count > 0) std::memcpy(b.data(), values, b.size());
  return b;
}

constexpr std::size_t heap_head_size = 16;
constexpr std::size_t largest_common_heap = 65536;  // a longer text has a heap of its own
constexpr std::size_t first_rows = 16;              // of a column that grows
const std::string settings = "study";               // the group that tells how the run ended

}  // namespace

struct ResultTree::Link {
  std::string name;
  std::unique_ptr<Group> group;  // nothing for a dataset
  std::uint64_t address = 0, committed = 0;
};

struct ResultTree::Group {
  std::vector<std::pair<std::string, AttributeValue>> attributes;
  std::vector<Link> links;  // in the order of creation
  bool changed = true;

  Link& link(const std::string& name) {
    const auto it = std::find_if(links.rbegin(), links.rend(), [&](const Link& l) { return l.name == name; });
    if (it != links.rend()) return *it;
    links.emplace_back().name = name;
    return links.back();
  }
};

struct ResultTree::Extended {
  std::uint64_t address = 0;
  std::size_t capacity = 0;
  Bytes data;
};

ResultTree::ResultTree(AppendFile& file) : file_(file), root_(std::make_unique<Group>()) {}
ResultTree::~ResultTree() = default;

bool ResultTree::changed() const { return root_->changed; }

ResultTree::Group& ResultTree::group(const std::string& path) {
  Group* current = root_.get();
  current->changed = true;
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    begin = end + 1;
    if (part.empty()) continue;
    Link& link = current->link(part);
    if (!link.group) {
      if (link.address != 0) throw std::invalid_argument(fmt::format("{} is a column, not a group", path));
      link.group = std::make_unique<Group>();
    }
    current = link.group.get();
    current->changed = true;
  }
  return *current;
}

void ResultTree::put_attribute(const std::string& path, const std::string& name, AttributeValue value) {
  auto& all = group(path).attributes;
  const auto it = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.first == name; });
  if (it != all.end()) it->second = std::move(value);
  else all.emplace_back(name, std::move(value));
}

const AttributeValue* ResultTree::attribute(const std::string& name) const {
  for (const Link& l : root_->links)
    if (l.group && l.name == settings)
      for (const auto& a : l.group->attributes)
        if (a.first == name) return &a.second;
  return nullptr;
}

void ResultTree::put_dataset(const std::string& path, const std::string& name, const Message& type, std::optional<std::size_t> rows,
                             std::uint64_t address, std::size_t bytes, const TextAttributes& attributes) {
  if (name.empty() || name.find('/') != std::string::npos) throw std::invalid_argument(fmt::format("\"{}\" cannot name a dataset", name));
  Link& link = group(path).link(name);
  if (link.group) throw std::invalid_argument(fmt::format("{}/{} is a group, not a column", path, name));
  std::vector<Message> messages{dataspace(rows), type, fill_value(), contiguous(address, bytes)};
  for (const auto& [key, text] : attributes) messages.push_back(encoded(key, text));
  link.address = file_.append(object_header(messages));
  holds_columns_ = holds_columns_ || rows;
}

void ResultTree::put_column(const std::string& path, const std::string& name, const std::vector<double>& values, const TextAttributes& attributes) {
  extended_.erase(path + "/" + name);
  const Bytes data = raw(values.data(), values.size());
  put_dataset(path, name, float_type(), values.size(), file_.append(data), data.size(), attributes);
}

void ResultTree::put_column(const std::string& path, const std::string& name, const std::vector<std::string>& values,
                            const TextAttributes& attributes) {
  extended_.erase(path + "/" + name);
  const Bytes data = references(values);
  put_dataset(path, name, text_type(), values.size(), file_.append(data), data.size(), attributes);
}

void ResultTree::put_scalar(const std::string& path, const std::string& name, double value, const TextAttributes& attributes) {
  const Bytes data = raw(&value, 1);
  put_dataset(path, name, float_type(), std::nullopt, file_.append(data), data.size(), attributes);
}

void ResultTree::put_scalar(const std::string& path, const std::string& name, const std::string& value, const TextAttributes& attributes) {
  const Bytes data = reference(value);
  put_dataset(path, name, text_type(), std::nullopt, file_.append(data), data.size(), attributes);
}

void ResultTree::extend_column(const std::string& path, const std::string& name, const std::vector<double>& values,
                               const TextAttributes& attributes) {
  extend(path, name, float_type(), sizeof(double), raw(values.data(), values.size()), attributes);
}

void ResultTree::extend_column(const std::string& path, const std::string& name, const std::vector<std::string>& values,
                               const TextAttributes& attributes) {
  extend(path, name, text_type(), text_reference_size, references(values), attributes);
}

void ResultTree::extend(const std::string& path, const std::string& name, const Message& type, std::size_t element, std::string_view data,
                        const TextAttributes& attributes) {
  Extended& column = extended_[path + "/" + name];
  const std::size_t before = column.data.size();
  column.data += data;
  if (column.data.size() > column.capacity) {
    column.capacity = std::max(2 * column.data.size(), first_rows * element);
    column.address = file_.allocate(column.capacity);
    file_.fill(column.address, column.data);
  } else {
    file_.fill(column.address + before, data);  // beyond the rows that the committed header counts
  }
  put_dataset(path, name, type, column.data.size() / element, column.address, column.data.size(), attributes);
}

// Texts ---------------------------------------------------------------------------------------------------------------------------------------------

Bytes ResultTree::references(const std::vector<std::string>& texts) {
  Bytes all;
  for (const auto& text : texts) all += reference(text);
  return all;
}

Bytes ResultTree::reference(const std::string& text) {
  if (text.empty()) return text_reference(0, 0, 0);
  const Bytes object = heap_object(heap_.texts + 1, text);
  if (heap_.used + object.size() > heap_.size || heap_.texts + 1 == most_texts_in_heap) {
    begin_heap(object.size());
    return reference(text);
  }
  file_.fill(heap_.address + heap_.used, object);
  heap_.used += object.size();
  return text_reference(text.size(), heap_.address, ++heap_.texts);
}

/// The next heap of a commit is four times the one before, up to a size.
void ResultTree::begin_heap(std::size_t needed) {
  const std::size_t usual = std::min(std::max(smallest_heap, 4 * heap_.size), largest_common_heap);
  end_heap();
  heap_.size = std::max(usual, heap_head_size + needed);
  heap_.address = file_.allocate(heap_.size);
  file_.fill(heap_.address, heap_head(heap_.size));
  heap_.used = heap_head_size;
}

void ResultTree::end_heap() {
  const std::size_t free = heap_.size - heap_.used;
  if (free >= heap_head_size) file_.fill(heap_.address + heap_.used, heap_rest(free));
  heap_ = {};
}

// Groups --------------------------------------------------------------------------------------------------------------------------------------------

Message ResultTree::encoded(const std::string& name, const AttributeValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return hdf5_format::attribute(name, float_type(), dataspace(std::nullopt), raw(number, 1));
  if (const auto* text = std::get_if<std::string>(&value))
    return hdf5_format::attribute(name, text_type(), dataspace(std::nullopt), reference(*text));
  if (const auto* numbers = std::get_if<std::vector<double>>(&value))
    return hdf5_format::attribute(name, float_type(), dataspace(numbers->size()), raw(numbers->data(), numbers->size()));
  const auto& texts = std::get<std::vector<std::string>>(value);
  return hdf5_format::attribute(name, text_type(), dataspace(texts.size()), references(texts));
}

std::uint64_t ResultTree::write(Group& group) {
  std::vector<Message> messages{link_info(group.links.size()), group_info()};
  for (const auto& [name, value] : group.attributes) messages.push_back(encoded(name, value));
  std::uint64_t order = 0;
  for (Link& link : group.links) {
    if (link.group && link.group->changed) link.address = write(*link.group);
    messages.push_back(hard_link(link.name, order++, link.address));
  }
  return file_.append(object_header(messages));
}

void ResultTree::commit() {
  const std::uint64_t root = write(*root_);
  end_heap();
  file_.commit(root);
  const auto settle = [](auto&& self, Group& group) -> void {
    if (!group.changed) return;
    group.changed = false;
    for (Link& link : group.links) {
      link.committed = link.address;
      if (link.group) self(self, *link.group);
    }
  };
  settle(settle, *root_);
}

void ResultTree::roll_back() {
  file_.roll_back_to_reserve();
  heap_ = {};
  const auto restore = [](auto&& self, Group& group) -> void {
    std::erase_if(group.links, [](const Link& link) { return link.committed == 0 && link.name != settings; });
    for (Link& link : group.links) {
      link.address = link.committed;
      if (link.group) self(self, *link.group);
    }
    group.changed = false;
  };
  restore(restore, *root_);
  group("/" + settings);
}

}  // namespace whirl::studies
