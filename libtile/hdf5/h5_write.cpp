#include "libtile/hdf5/h5_write.h"

#include <algorithm>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_handle.h"
#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/seal.h"

namespace rayfield::tile {
namespace {

tl::unexpected<Error> refused(const char* step) {
  return fail(ErrorCode::internal, "cannot build HDF5 image", step, "the HDF5 library refused",
              "please report this with the command line");
}

// A file in memory that nothing of the machine or the moment enters: no object times, oldest structures.
H5Handle create_file() {
  H5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (!creation.valid() || !access.valid()) return {};
  if (H5Pset_istore_k(creation.get(), kChunkTreeK) < 0 || H5Pset_sym_k(creation.get(), kGroupTreeK, kSymbolNodeK) < 0 ||
      H5Pset_obj_track_times(creation.get(), false) < 0 ||
      H5Pset_fapl_core(access.get(), std::size_t{1} << 20, false) < 0 ||
      H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST) < 0)
    return {};
  return {H5Fcreate("rayfield-image", H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose};
}

H5Handle create_properties() {
  H5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (properties.valid() && (H5Pset_obj_track_times(properties.get(), false) < 0 ||
                             H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER) < 0))
    return {};
  return properties;
}

bool write_attributes(hid_t file, const std::string& text) {
  H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Handle properties = create_properties();
  if (!type.valid() || !space.valid() || !properties.valid()) return false;
  const std::string padded = text.empty() ? std::string(1, ' ') : text;
  if (H5Tset_size(type.get(), padded.size()) < 0 || H5Tset_strpad(type.get(), H5T_STR_NULLPAD) < 0 ||
      H5Tset_cset(type.get(), H5T_CSET_UTF8) < 0)
    return false;
  H5Handle dataset(
      H5Dcreate2(file, kAttributesDataset, type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  return dataset.valid() && H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) >= 0;
}

H5Handle create_column(hid_t group, const ImageColumn& column) {
  const hsize_t count = column.count, chunk = column.chunk_elements;
  H5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  H5Handle properties = create_properties();
  if (!space.valid() || !properties.valid()) return {};
  if (column.count > 0) {
    const std::vector<unsigned> values =
        blosc_filter_values(element_size(column.type), column.chunk_elements * element_size(column.type));
    // Optional, because the library at hand need not know the filter: chunks are written as they will stand.
    if (H5Pset_chunk(properties.get(), 1, &chunk) < 0 ||
        H5Pset_filter(properties.get(), kBloscFilter, H5Z_FLAG_OPTIONAL, values.size(), values.data()) < 0)
      return {};
  }
  return {H5Dcreate2(group, column.name.c_str(), h5_file_type(column.type), space.get(), H5P_DEFAULT, properties.get(),
                     H5P_DEFAULT),
          H5Dclose};
}

Result<void> write_columns(hid_t file, const std::vector<ImageColumn>& columns) {
  H5Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  if (!creation.valid() || H5Pset_obj_track_times(creation.get(), false) < 0) return refused("group properties");
  H5Handle group(H5Gcreate2(file, kColumnsGroup, H5P_DEFAULT, creation.get(), H5P_DEFAULT), H5Gclose);
  if (!group.valid()) return refused("group");
  std::vector<H5Handle> datasets;
  std::size_t chunks = 0;
  for (const ImageColumn& column : columns) {
    datasets.push_back(create_column(group.get(), column));
    if (!datasets.back().valid()) return refused("dataset");
    chunks = std::max(chunks, column.chunks.size());
  }
  for (std::size_t c = 0; c < chunks; ++c) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (c >= columns[k].chunks.size()) continue;
      const hsize_t offset = c * columns[k].chunk_elements;
      const std::span<const std::byte> bytes = columns[k].chunks[c];
      if (H5Dwrite_chunk(datasets[k].get(), H5P_DEFAULT, 0, &offset, bytes.size(), bytes.data()) < 0)
        return refused("chunk");
    }
  }
  for (H5Handle& dataset : datasets) {
    if (!dataset.close()) return refused("close dataset");
  }
  return {};
}

// What the reader would refuse is not written.
Result<void> check_columns(const std::vector<ImageColumn>& columns) {
  if (columns.size() > kMostColumns)
    return fail(ErrorCode::internal, "cannot build HDF5 image", std::to_string(columns.size()) + " columns",
                "a file holds at most " + std::to_string(kMostColumns));
  for (const ImageColumn& column : columns) {
    const bool good_name = !column.name.empty() && column.name.size() <= kMostNameBytes && column.name != "." &&
                           column.name.find('/') == std::string::npos && column.name.find('\0') == std::string::npos;
    const std::uint64_t chunks =
        column.chunk_elements == 0 ? 0 : (column.count + column.chunk_elements - 1) / column.chunk_elements;
    if (!good_name || column.chunk_elements == 0 || column.chunk_elements > kMostChunkElements ||
        chunks != column.chunks.size())
      return fail(ErrorCode::internal, "cannot build HDF5 image", "column '" + column.name + "'",
                  "a column needs a short name without '/' and all of its chunks");
  }
  return {};
}

}  // namespace

Result<std::vector<std::byte>> build_image(const std::string& attributes, const std::vector<ImageColumn>& columns) {
  RAYFIELD_CHECK(check_columns(columns));
  std::vector<std::byte> image;
  {
    const H5Session session;
    H5Handle file = create_file();
    if (!file.valid()) return refused("file");
    if (!write_attributes(file.get(), attributes)) return refused("attributes");
    RAYFIELD_CHECK(write_columns(file.get(), columns));
    if (H5Fflush(file.get(), H5F_SCOPE_GLOBAL) < 0) return refused("flush");
    const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
    if (size <= 0) return refused("image size");
    image.reserve(static_cast<std::size_t>(size) + kSealSize);
    image.resize(static_cast<std::size_t>(size));
    if (H5Fget_file_image(file.get(), image.data(), image.size()) != size) return refused("image");
    if (!file.close()) return refused("close");
  }
  append_seal(image);
  return image;
}

}  // namespace rayfield::tile
