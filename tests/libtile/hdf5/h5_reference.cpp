#include "tests/libtile/hdf5/h5_reference.h"

#include <gmock/gmock.h>

#include <array>
#include <stdexcept>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_handle.h"
#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/seal.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

hid_t checked(hid_t id) {
  if (id < 0) throw std::runtime_error("the HDF5 library refused");
  return id;
}

H5Handle memory_access() {
  H5Handle access(checked(H5Pcreate(H5P_FILE_ACCESS)), H5Pclose);
  checked(H5Pset_fapl_core(access.get(), 4096, false));
  return access;
}

ElementType type_of(hid_t dataset) {
  const H5Handle type(checked(H5Dget_type(dataset)), H5Tclose);
  for (const ElementType candidate : {ElementType::u8, ElementType::u16, ElementType::i32, ElementType::u32,
                                      ElementType::i64, ElementType::u64, ElementType::f32, ElementType::f64}) {
    if (H5Tequal(type.get(), h5_file_type(candidate)) > 0) return candidate;
  }
  throw std::runtime_error("a type that no column has");
}

ColumnLayout column_by_library(hid_t group, const std::string& name) {
  const H5Handle dataset(checked(H5Dopen2(group, name.c_str(), H5P_DEFAULT)), H5Dclose);
  const H5Handle space(checked(H5Dget_space(dataset.get())), H5Sclose);
  const H5Handle creation(checked(H5Dget_create_plist(dataset.get())), H5Pclose);
  hsize_t count = 0, chunk = 0, chunks = 0;
  checked(H5Sget_simple_extent_dims(space.get(), &count, nullptr));
  ColumnLayout column{name, type_of(dataset.get()), count, 1, {}};
  if (count == 0) return column;
  checked(H5Pget_chunk(creation.get(), 1, &chunk));
  checked(H5Dget_num_chunks(dataset.get(), space.get(), &chunks));
  column.chunk_elements = chunk;
  column.chunks.resize(chunks);
  for (hsize_t i = 0; i < chunks; ++i) {
    hsize_t offset = 0, size = 0;
    unsigned mask = 0;
    haddr_t address = 0;
    checked(H5Dget_chunk_info(dataset.get(), space.get(), i, &offset, &mask, &address, &size));
    column.chunks.at(offset / chunk) = {address, size};
  }
  return column;
}

}  // namespace

ImageLayout layout_by_library(std::span<const std::byte> image) {
  const H5Session session;
  image = unsealed(image);
  std::vector<std::byte> copy(image.begin(), image.end());
  const H5Handle access = memory_access();
  checked(H5Pset_file_image(access.get(), copy.data(), copy.size()));
  const H5Handle file(checked(H5Fopen("image", H5F_ACC_RDONLY, access.get())), H5Fclose);
  const H5Handle text(checked(H5Dopen2(file.get(), kAttributesDataset, H5P_DEFAULT)), H5Dclose);
  const H5Handle type(checked(H5Dget_type(text.get())), H5Tclose);
  ImageLayout layout;
  layout.attributes.resize(H5Tget_size(type.get()));
  checked(H5Dread(text.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, layout.attributes.data()));
  const H5Handle group(checked(H5Gopen2(file.get(), kColumnsGroup, H5P_DEFAULT)), H5Gclose);
  H5G_info_t info{};
  checked(H5Gget_info(group.get(), &info));
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::array<char, 512> name{};
    checked(H5Lget_name_by_idx(group.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT));
    layout.columns.push_back(column_by_library(group.get(), name.data()));
  }
  return layout;
}

void expect_refused(const char* what, std::span<const std::byte> image, const char* why) {
  {
    const H5Session session;
    const H5Handle access = memory_access();
    const std::span<const std::byte> content = unsealed(image);
    std::vector<std::byte> copy(content.begin(), content.end());
    checked(H5Pset_file_image(access.get(), copy.data(), copy.size()));
    const H5Handle file(H5Fopen("image", H5F_ACC_RDONLY, access.get()), H5Fclose);
    EXPECT_TRUE(file.valid()) << what;
  }
  const auto layout = read_layout(image, "foreign.h5");
  ASSERT_FALSE(layout) << what;
  EXPECT_EQ(layout.error().code, ErrorCode::damaged) << what;
  EXPECT_THAT(layout.error().line(), AllOf(HasSubstr("foreign.h5 at byte "), HasSubstr(why))) << what;
}

std::size_t place_of(std::span<const std::byte> image, std::string_view text, std::size_t n) {
  const std::string_view all(reinterpret_cast<const char*>(image.data()), image.size());
  std::size_t at = all.find(text);
  for (; n > 0; --n) at = all.find(text, at + 1);
  if (at == std::string_view::npos) throw std::runtime_error("not found in the image");
  return at;
}

void make_column(hid_t group, const char* name, hid_t type, const std::function<void(hid_t)>& change) {
  const hsize_t count = 4, first = 0;
  const H5Handle space(checked(H5Screate_simple(1, &count, nullptr)), H5Sclose);
  const H5Handle creation(checked(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  checked(H5Pset_obj_track_times(creation.get(), false));
  checked(H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER));
  checked(H5Pset_chunk(creation.get(), 1, &count));
  if (change) change(creation.get());
  if (!change) {
    const std::vector<unsigned> values = blosc_filter_values(H5Tget_size(type), 4 * H5Tget_size(type));
    checked(H5Pset_filter(creation.get(), kBloscFilter, H5Z_FLAG_OPTIONAL, values.size(), values.data()));
  }
  const H5Handle dataset(checked(H5Dcreate2(group, name, type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT)),
                         H5Dclose);
  if (H5Pget_layout(creation.get()) != H5D_CHUNKED) return;
  const std::vector<std::byte> numbers(4 * H5Tget_size(type));
  std::vector<std::byte> blob;
  compress(numbers, H5Tget_size(type), blob);
  checked(H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 0, &first, blob.size(), blob.data()));
}

ForeignSteps::ForeignSteps() : column([](hid_t group) { make_column(group, "v", H5T_STD_U32LE); }) {}

std::vector<std::byte> ForeignSteps::image() const {
  const H5Session session;
  const H5Handle creation(checked(H5Pcreate(H5P_FILE_CREATE)), H5Pclose);
  const H5Handle access = memory_access();
  checked(H5Pset_istore_k(creation.get(), kChunkTreeK));
  checked(H5Pset_sym_k(creation.get(), kGroupTreeK, kSymbolNodeK));
  checked(H5Pset_obj_track_times(creation.get(), false));
  file(creation.get(), access.get());
  const H5Handle made(checked(H5Fcreate("foreign", H5F_ACC_TRUNC, creation.get(), access.get())), H5Fclose);
  const std::string json = R"({"format":"rayfield-arrays","version":1,"kind":"k","kind_version":1,"attributes":"{}"})";
  const H5Handle type(checked(H5Tcopy(H5T_C_S1)), H5Tclose), space(checked(H5Screate(H5S_SCALAR)), H5Sclose);
  checked(H5Tset_size(type.get(), json.size()));
  checked(H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
  checked(H5Tset_cset(type.get(), H5T_CSET_UTF8));
  text(type.get());
  const H5Handle properties(checked(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  checked(H5Pset_obj_track_times(properties.get(), false));
  const H5Handle dataset(checked(H5Dcreate2(made.get(), kAttributesDataset, type.get(), space.get(), H5P_DEFAULT,
                                            properties.get(), H5P_DEFAULT)),
                         H5Dclose);
  const char* const pointer = json.c_str();
  checked(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                   H5Tis_variable_str(type.get()) > 0 ? static_cast<const void*>(&pointer) : pointer));
  const H5Handle group_properties(checked(H5Pcreate(H5P_GROUP_CREATE)), H5Pclose);
  checked(H5Pset_obj_track_times(group_properties.get(), false));
  const H5Handle group(checked(H5Gcreate2(made.get(), kColumnsGroup, H5P_DEFAULT, group_properties.get(), H5P_DEFAULT)),
                       H5Gclose);
  column(group.get());
  more(made.get());
  checked(H5Fflush(made.get(), H5F_SCOPE_GLOBAL));
  std::vector<std::byte> image(static_cast<std::size_t>(checked(H5Fget_file_image(made.get(), nullptr, 0))));
  checked(H5Fget_file_image(made.get(), image.data(), image.size()));
  append_seal(image);
  return image;
}

}  // namespace rayfield::tile::testing
