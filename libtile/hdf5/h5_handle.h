#pragma once

#include <hdf5.h>

#include <mutex>
#include <utility>

#include "libtile/hdf5/element_type.h"

namespace rayfield::tile {

/// Owns an HDF5 identifier.
class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  H5Handle() = default;
  H5Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  H5Handle(H5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  H5Handle& operator=(H5Handle&&) = delete;
  ~H5Handle() { close(); }
  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }
  bool close() {
    const hid_t id = std::exchange(id_, -1);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// While it lives this thread is the only one in the library, which prints nothing and loads no plugins.
class H5Session {
 public:
  H5Session();

 private:
  std::unique_lock<std::mutex> lock_;
};

/// The little-endian file type of an element.
hid_t h5_file_type(ElementType type);

}  // namespace rayfield::tile
