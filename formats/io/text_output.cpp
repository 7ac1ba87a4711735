#include "rayfield/formats/text_output.h"

#include "formats/io/file_io.h"

namespace rayfield::formats {

Result<void> write_text_file(const std::string& path, std::string_view text, const std::string& what) {
  RAYFIELD_ASSIGN(OutputFile file, OutputFile::create(path, what));
  RAYFIELD_CHECK(file.write(text));
  return file.commit();
}

}  // namespace rayfield::formats
