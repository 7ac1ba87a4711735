#include "libtile/hdf5/h5_read.h"

#include <algorithm>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_handle.h"
#include "libtile/hdf5/seal.h"
#include "rayfield/core/file.h"

namespace rayfield::tile {
namespace {

// Bounds on what a file may claim before it is believed.
constexpr hsize_t kMaxColumns = 4096;
constexpr std::size_t kMaxAttributes = std::size_t{256} << 20;

tl::unexpected<Error> unreadable(const std::string& where, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read file of the store", where, why, "run `rayfield verify`");
}

Result<std::string> read_attributes(hid_t file, const std::string& where) {
  H5Handle dataset(H5Dopen2(file, kAttributesDataset, H5P_DEFAULT), H5Dclose);
  if (!dataset.valid()) return unreadable(where, "it has no attributes");
  H5Handle type(H5Dget_type(dataset.get()), H5Tclose);
  H5Handle space(H5Dget_space(dataset.get()), H5Sclose);
  if (!type.valid() || !space.valid() || H5Tget_class(type.get()) != H5T_STRING ||
      H5Tis_variable_str(type.get()) != 0 || H5Sget_simple_extent_npoints(space.get()) != 1 ||
      H5Tget_size(type.get()) > kMaxAttributes)
    return unreadable(where, "its attributes are not one text");
  std::string text(H5Tget_size(type.get()), '\0');
  if (H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0)
    return unreadable(where, "its attributes cannot be read");
  return text;
}

bool read_type(hid_t dataset, ElementType& element) {
  H5Handle type(H5Dget_type(dataset), H5Tclose);
  if (!type.valid()) return false;
  for (const ElementType candidate : {ElementType::u8, ElementType::u16, ElementType::i32, ElementType::u32,
                                      ElementType::i64, ElementType::u64, ElementType::f32, ElementType::f64}) {
    if (H5Tequal(type.get(), h5_file_type(candidate)) > 0) {
      element = candidate;
      return true;
    }
  }
  return false;
}

// Chunked, one dimension, Blosc and nothing else, no data outside the file.
bool read_chunking(hid_t dataset, ColumnLayout& column) {
  H5Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (!properties.valid() || H5Pget_external_count(properties.get()) != 0 ||
      H5Pget_layout(properties.get()) != H5D_CHUNKED || H5Pget_nfilters(properties.get()) != 1)
    return false;
  unsigned flags = 0;
  std::size_t values = 0;
  if (H5Pget_filter2(properties.get(), 0, &flags, &values, nullptr, 0, nullptr, nullptr) != kBloscFilter) return false;
  hsize_t chunk = 0;
  if (H5Pget_chunk(properties.get(), 1, &chunk) != 1 || chunk == 0) return false;
  column.chunk_elements = chunk;
  return true;
}

Result<void> read_chunks(hid_t dataset, hid_t space, std::uint64_t file_bytes, ColumnLayout& column,
                         const std::string& where) {
  const std::uint64_t expected = (column.count - 1) / column.chunk_elements + 1;
  hsize_t present = 0;
  if (H5Dget_num_chunks(dataset, space, &present) < 0 || present != expected)
    return unreadable(where, "column '" + column.name + "' lacks chunks");
  column.chunks.resize(expected);
  for (hsize_t i = 0; i < present; ++i) {
    hsize_t offset = 0, size = 0;
    unsigned mask = 0;
    haddr_t address = HADDR_UNDEF;
    if (H5Dget_chunk_info(dataset, space, i, &offset, &mask, &address, &size) < 0 || mask != 0 ||
        address == HADDR_UNDEF || address > file_bytes || size > file_bytes - address ||
        offset % column.chunk_elements != 0 || offset / column.chunk_elements >= expected)
      return unreadable(where, "column '" + column.name + "' has a chunk out of place");
    column.chunks[offset / column.chunk_elements] = ChunkPlace{address, size};
  }
  return {};
}

Result<ColumnLayout> read_column(hid_t group, hsize_t index, std::uint64_t file_bytes, const std::string& where) {
  std::string name(256, '\0');
  const ssize_t length =
      H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, index, name.data(), name.size(), H5P_DEFAULT);
  if (length <= 0 || static_cast<std::size_t>(length) >= name.size()) return unreadable(where, "a column has no name");
  name.resize(static_cast<std::size_t>(length));
  H5L_info_t link{};
  if (H5Lget_info(group, name.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)
    return unreadable(where, "column '" + name + "' is a link to elsewhere");
  H5Handle dataset(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.valid()) return unreadable(where, "column '" + name + "' cannot be opened");
  ColumnLayout column;
  column.name = name;
  H5Handle space(H5Dget_space(dataset.get()), H5Sclose);
  hsize_t count = 0;
  if (!space.valid() || H5Sget_simple_extent_ndims(space.get()) != 1 ||
      H5Sget_simple_extent_dims(space.get(), &count, nullptr) != 1 || !read_type(dataset.get(), column.type))
    return unreadable(where, "column '" + name + "' is not a list of numbers of a known type");
  column.count = count;
  if (count == 0) return column;
  if (!read_chunking(dataset.get(), column))
    return unreadable(where, "column '" + name + "' is not stored as this version of rayfield stores it");
  // Nothing compresses by more than Blosc's own bound, so a count beyond it is a lie, not a size to allocate.
  if (column.count / (std::uint64_t{1} << 20) > file_bytes || column.chunk_elements > (std::uint64_t{1} << 27))
    return unreadable(where, "column '" + name + "' claims more elements than the file can hold");
  RAYFIELD_CHECK(read_chunks(dataset.get(), space.get(), file_bytes, column, where));
  return column;
}

Result<ImageLayout> read_open_file(hid_t file, std::uint64_t file_bytes, const std::string& where) {
  ImageLayout layout;
  RAYFIELD_ASSIGN(layout.attributes, read_attributes(file, where));
  H5Handle group(H5Gopen2(file, kColumnsGroup, H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (!group.valid() || H5Gget_info(group.get(), &info) < 0 || info.nlinks > kMaxColumns)
    return unreadable(where, "it has no columns");
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    RAYFIELD_ASSIGN(ColumnLayout column, read_column(group.get(), i, file_bytes, where));
    layout.columns.push_back(std::move(column));
  }
  return layout;
}

}  // namespace

const ColumnLayout* ImageLayout::find(const std::string& name) const {
  const auto it = std::find_if(columns.begin(), columns.end(), [&](const ColumnLayout& c) { return c.name == name; });
  return it == columns.end() ? nullptr : &*it;
}

Result<ImageLayout> read_layout(std::span<const std::byte> image, const std::string& where) {
  if (!is_sealed(image))
    return unreadable(where, "its bytes do not agree with its seal (damaged, or not of this store)");
  image = image.first(image.size() - kSealSize);
  const H5Session session;
  H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // The library copies the image and only reads the copy: its parameter is not const for other uses.
  void* const bytes = const_cast<std::byte*>(image.data());
  if (!access.valid() || H5Pset_fapl_core(access.get(), std::size_t{1} << 20, false) < 0 ||
      H5Pset_file_image(access.get(), bytes, image.size()) < 0)
    return fail(ErrorCode::resources, "cannot read file of the store", where, "out of memory");
  const H5Handle file(H5Fopen("rayfield-image", H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!file.valid()) return unreadable(where, "it is not an HDF5 file");
  return read_open_file(file.get(), image.size(), where);
}

Result<ImageLayout> read_layout(const std::filesystem::path& checked_file) {
  const std::string where = checked_file.string();
  RAYFIELD_ASSIGN(const InputDescriptor input, open_regular_file(where, "cannot read file of the store"));
  const H5Session session;
  H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Files are immutable: a lock would only fail on read-only network folders.
  if (!access.valid() || H5Pset_fapl_sec2(access.get()) < 0 || H5Pset_file_locking(access.get(), false, true) < 0)
    return fail(ErrorCode::internal, "cannot read file of the store", where, "the HDF5 library refused");
  const H5Handle file(H5Fopen(where.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!file.valid()) return unreadable(where, "it is not an HDF5 file");
  return read_open_file(file.get(), input.size, where);
}

}  // namespace rayfield::tile
