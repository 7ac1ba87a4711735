// A library to preload: makes one call of a program fail, as a bad disk or a lack of memory would.
//
//   RAYFIELD_FAILING_CALL="readdir /snapshots 2 5"    call, what its path ends with, from which such call on, errno
//
// Calls: readdir, fstat, stat. All from that one on fail, since a program may ask again.
#include <dirent.h>
#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <sstream>
#include <string>

namespace {

struct Failure {
  std::string call, end;
  int from = 0, error = 0;
};

const Failure& failure() {
  static const Failure kWanted = [] {
    Failure f;
    if (const char* text = std::getenv("RAYFIELD_FAILING_CALL"))
      std::istringstream(text) >> f.call >> f.end >> f.from >> f.error;
    return f;
  }();
  return kWanted;
}

std::string path_of(int descriptor) {
  char path[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t length = ::readlink(link.c_str(), path, sizeof(path));
  return length > 0 ? std::string(path, static_cast<std::size_t>(length)) : std::string();
}

bool fails(const char* call, const std::string& path) {
  static std::atomic<int> calls = 0;
  const Failure& f = failure();
  if (f.call != call || !path.ends_with(f.end) || ++calls < f.from) return false;
  errno = f.error;
  return true;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

dirent* readdir(DIR* folder) {
  static const auto kReal = next<dirent* (*)(DIR*)>("readdir");
  return failure().call == "readdir" && fails("readdir", path_of(::dirfd(folder))) ? nullptr : kReal(folder);
}

int fstat(int descriptor, struct stat* status) noexcept {
  static const auto kReal = next<int (*)(int, struct stat*)>("fstat");
  return failure().call == "fstat" && fails("fstat", path_of(descriptor)) ? -1 : kReal(descriptor, status);
}

int stat(const char* path, struct stat* status) noexcept {
  static const auto kReal = next<int (*)(const char*, struct stat*)>("stat");
  return failure().call == "stat" && fails("stat", path) ? -1 : kReal(path, status);
}

}  // extern "C"
