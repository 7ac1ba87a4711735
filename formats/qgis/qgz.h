#pragma once

#include <string>
#include <string_view>

#include "formats/gis/gdal_session.h"

namespace rayfield::formats::qgis {

/// A project as QGIS packs it: a ZIP archive with one `.qgs` file, in memory, since it becomes a value in a table
/// (archives on disk: io/zip_file.h). Equal projects are equal bytes. `what`, `where`: of the job, for messages.
/// Errors: GDAL's.
Result<std::string> qgz(const GdalSession& gdal, std::string_view project_xml, std::string_view what,
                        std::string_view where);

}  // namespace rayfield::formats::qgis
