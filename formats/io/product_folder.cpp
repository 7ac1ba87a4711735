#include "rayfield/formats/product_folder.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "formats/io/staged_output.h"
#include "rayfield/core/file.h"

namespace rayfield::formats {

namespace fs = std::filesystem;

struct ProductFolder::Impl {
  fs::path folder;
  std::string last;
  StagedOutput staged;
};

namespace {

// Names of the regular files in the private folder; what else is there is a writer's own and on its way out.
Result<std::vector<std::string>> names_in(const StagedOutput& staged) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(staged.path(""), error), end; !error && it != end; it.increment(error)) {
    if (it->is_regular_file(error)) names.push_back(it->path().filename().string());
    if (error) break;  // before increment() forgets it: a product would be missing without a word
  }
  if (error) return fail_errno(error.value(), staged.what(), staged.target());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

Result<ProductFolder> ProductFolder::create(const std::string& folder, const std::string& last,
                                            const std::string& what) {
  RAYFIELD_ASSIGN(StagedOutput staged, StagedOutput::create((fs::path(folder) / last).string(), what));
  ProductFolder products;
  products.impl_ = std::make_shared<const Impl>(Impl{folder, last, std::move(staged)});
  return products;
}

std::string ProductFolder::path(const std::string& name) const { return impl_->staged.path(name); }

Result<std::vector<ProductFile>> ProductFolder::files() const {
  RAYFIELD_ASSIGN(const std::vector<std::string> names, names_in(impl_->staged));
  std::vector<ProductFile> files;
  for (const std::string& name : names) {
    RAYFIELD_ASSIGN(FileDigest digest, digest_file(path(name), impl_->staged.what()));
    files.push_back({name, digest.size, std::move(digest.sha256)});
  }
  return files;
}

Result<void> ProductFolder::publish() const {
  RAYFIELD_ASSIGN(std::vector<std::string> names, names_in(impl_->staged));
  // Before anything is renamed: what comes later in the folder must not fail after what comes first has changed.
  for (const std::string& name : names) {
    std::error_code ignored;
    if (fs::is_directory(impl_->folder / name, ignored))
      return fail(ErrorCode::resources, impl_->staged.what(), (impl_->folder / name).string(), "a folder is in the way",
                  "move it away, or choose another folder");
  }
  std::stable_partition(names.begin(), names.end(), [&](const std::string& name) { return name != impl_->last; });
  for (const std::string& name : names) {
    std::error_code ignored;
    fs::remove(impl_->folder / (name + ".aux.xml"), ignored);
    RAYFIELD_CHECK(impl_->staged.publish(name, (impl_->folder / name).string()));
  }
  return {};
}

}  // namespace rayfield::formats
