#pragma once
/// What stands behind a result file: an object of the HDF5 library, closed with its handle, or a file that a run writes.

#include <cstdint>
#include <utility>

namespace whirl::studies {

class HdfHandle {
 public:
  using Id = std::int64_t;  ///< hid_t
  using Close = int (*)(Id);
  HdfHandle() = default;
  HdfHandle(Id id, Close close) : id_(id), close_(close) {}
  HdfHandle(HdfHandle&& other) noexcept : id_(std::exchange(other.id_, Id{-1})), close_(other.close_) {}
  HdfHandle& operator=(HdfHandle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  virtual ~HdfHandle() {
    if (id_ >= 0) close_(id_);
  }
  operator Id() const { return id_; }

 private:
  Id id_ = -1;
  Close close_ = nullptr;
};

}  // namespace whirl::studies
