#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstring>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "libtile/hdf5/h5_read.h"
#include "tests/libtile/hdf5/resealed.h"

namespace rayfield::tile::testing {

/// What the HDF5 library reads of an image (with its seal): the reference for read_layout(). Throws where the library
/// refuses it. Not for images that were tampered with: the library does not survive all of them.
ImageLayout layout_by_library(std::span<const std::byte> image);

/// A file as rayfield's writer makes it, but made step by step, so that a test can have a step its own way. Every step
/// is given what it may change.
struct ForeignSteps {
  std::function<void(hid_t file_creation, hid_t file_access)> file = [](hid_t, hid_t) {};
  std::function<void(hid_t text_type)> text = [](hid_t) {};
  /// Makes the column "v" in the group; by default as the writer does.
  std::function<void(hid_t group)> column;
  std::function<void(hid_t file)> more = [](hid_t) {};

  ForeignSteps();
  std::vector<std::byte> image() const;
};

/// The image of a file, without its seal.
inline std::span<const std::byte> unsealed(std::span<const std::byte> file) {
  return file.first(file.size() - kSealSize);
}

/// Expects that the library takes the image and rayfield refuses it with that reason, naming a place in it.
void expect_refused(const char* what, std::span<const std::byte> image, const char* why);

/// Where the text stands for the n-th time, from 0.
std::size_t place_of(std::span<const std::byte> image, std::string_view text, std::size_t n);

/// Overwrites a number.
template <class T>
void put(std::vector<std::byte>& image, std::size_t offset, T value) {
  std::memcpy(std::span(image).subspan(offset, sizeof(T)).data(), &value, sizeof(T));
}

/// A column of four numbers with one chunk, of the given type, with properties after a change of them.
void make_column(hid_t group, const char* name, hid_t type, const std::function<void(hid_t creation)>& change = {});

}  // namespace rayfield::tile::testing
