#pragma once

#include <gdal_priv.h>

#include <memory>
#include <string>

namespace rayfield::formats::testing {

struct DatasetCloser {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, DatasetCloser>;

/// `kind`: GDAL_OF_VECTOR or GDAL_OF_RASTER. Null where GDAL cannot read the file.
inline Dataset open_dataset(const std::string& path, unsigned int kind) {
  GDALAllRegister();
  return Dataset(GDALDataset::Open(path.c_str(), kind | GDAL_OF_READONLY));
}

}  // namespace rayfield::formats::testing
