#pragma once
/// What stands behind a result file: an object of the HDF5 library, closed with its handle, or a file that a run writes.

#include <hdf5.h>

#include <utility>

namespace whirl::studies {

class HdfHandle {
 public:
  using Close = herr_t (*)(hid_t);
  HdfHandle() = default;
  HdfHandle(hid_t id, Close close) : id_(id), close_(close) {}
  HdfHandle(HdfHandle&& other) noexcept : id_(std::exchange(other.id_, hid_t{-1})), close_(other.close_) {}
  HdfHandle& operator=(HdfHandle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  virtual ~HdfHandle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

}  // namespace whirl::studies
