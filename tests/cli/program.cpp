#include "tests/cli/program.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "rayfield/core/sha256.h"

namespace rayfield::test {

namespace fs = std::filesystem;

int Outcome::error_lines() const {
  int count = 0;
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("rayfield: ", 0) == 0) ++count;
  return count;
}

namespace {

// A run under way; `prepare` is called in the child before the program starts.
class Run {
 public:
  template <class F>
  Run(const std::vector<std::string>& arguments, F&& prepare, const std::string& stdout_path = {}) {
    child_ = fork();
    if (child_ != 0) return;
    prepare();
    const std::string out_path = stdout_path.empty() ? capture_.path("out") : stdout_path;
    const int out_file = open(out_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err_file = open(capture_.path("err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(out_file, STDOUT_FILENO);
    dup2(err_file, STDERR_FILENO);
    std::vector<std::string> words{RAYFIELD_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(127);
  }
  // Sends a signal once stderr holds `text`; gives up when the program has ended.
  void interrupt_at(const std::string& text) {
    while (wait4(child_, &status_, WNOHANG, &usage_) == 0) {
      if (read_file(capture_.path("err")).find(text) != std::string::npos) {
        kill(child_, SIGINT);
        return;
      }
      usleep(2000);
    }
    ended_ = true;
  }
  void interrupt_after(unsigned milliseconds) {
    usleep(1000 * milliseconds);
    kill(child_, SIGINT);
  }
  Outcome finish() {
    if (!ended_) wait4(child_, &status_, 0, &usage_);
    Outcome run;
    run.exit_code = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
    run.out = read_file(capture_.path("out"));
    run.err = read_file(capture_.path("err"));
    run.peak_bytes = static_cast<std::uint64_t>(usage_.ru_maxrss) << 10U;
    return run;
  }

 private:
  Folder capture_;
  pid_t child_ = -1;
  int status_ = 0;
  rusage usage_{};
  bool ended_ = false;
};

}  // namespace

Outcome rayfield(const std::vector<std::string>& arguments, const std::map<std::string, std::string>& environment) {
  return Run(arguments,
             [&] {
               for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
             })
      .finish();
}

Outcome rayfield_with_file_limit(const std::vector<std::string>& arguments, std::uint64_t bytes) {
  return Run(arguments,
             [&] {
               const rlimit limit{bytes, bytes};
               setrlimit(RLIMIT_FSIZE, &limit);
             })
      .finish();
}

Outcome rayfield_printing_to(const std::string& path, const std::vector<std::string>& arguments) {
  return Run(
             arguments, [] {}, path)
      .finish();
}

Outcome rayfield_interrupted_at(const std::vector<std::string>& arguments, const std::string& text) {
  Run run(arguments, [] {});
  run.interrupt_at(text);
  return run.finish();
}

Outcome rayfield_interrupted_after(const std::vector<std::string>& arguments, unsigned milliseconds) {
  Run run(arguments, [] {});
  run.interrupt_after(milliseconds);
  return run.finish();
}

Folder::Folder() {
  std::string pattern = (fs::temp_directory_path() / "rayfield-test-XXXXXX").string();
  root_ = mkdtemp(pattern.data());
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(root_, ignored);
}

std::string Folder::path(const std::string& name) const {
  return name.empty() ? root_.string() : (root_ / name).string();
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void write_file(const fs::path& path, const std::string& content) { std::ofstream(path, std::ios::binary) << content; }

std::map<std::string, std::string> content_of(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    const bool own = name.rfind("snapshots", 0) == 0 || name == "store.json" || name == "lock";
    if (entry.is_regular_file() && !own) content[name] = sha256_hex(std::string_view(read_file(entry.path())));
  }
  return content;
}

std::string small_site(const Folder& folder, const std::string& dates) {
  const std::string path = folder.path("site.toml");
  write_file(path, R"([site]
name = "small"
latitude_deg = 47.3
longitude_deg = 8.4
seed = 5
[terrain]
slope_percent = 3
[rows]
count = 2
length_m = 14
spacing_m = 2.5
azimuth_deg = 70
panel_length_m = 3.5
[canopy]
leaf_area_m2_per_m = 1.8
[surroundings]
trees = 1
buildings = 0
fence = false
[spinning]
beams = 143
)" + dates);
  return path;
}

}  // namespace rayfield::test
