#include "libtile/files/writer_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_layout.h"

namespace rayfield::tile {

Result<WriterLock> WriterLock::take(const std::filesystem::path& store) {
  const std::filesystem::path path = store / layout::kLock;
  if (const int error = fault::point("lock")) return fail_io(error, "cannot lock the store", path);
  FileDescriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (!file.valid()) return fail_io(errno, "cannot lock the store", path);
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK)
      return fail(ErrorCode::locked, "cannot change the store", store.string(), "another rayfield is writing to it",
                  "wait until it has finished");
    return fail_io(errno, "cannot lock the store", path);
  }
  RAYFIELD_CHECK(make_directories(store, layout::kTemporary));
  std::error_code ignored;  // what cannot be removed now is found by gc
  std::filesystem::directory_iterator entries(store / layout::kTemporary, ignored);
  for (; !ignored && entries != std::filesystem::directory_iterator(); entries.increment(ignored)) {
    if (entries->path().extension() == ".tmp") ::unlink(entries->path().c_str());
  }
  return WriterLock(std::move(file));
}

}  // namespace rayfield::tile
