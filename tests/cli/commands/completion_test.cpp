#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <sstream>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

struct Ran {
  std::string out;
  int status = -1;
};

// What a shell prints on both of its streams.
Ran shell(const std::string& command) {
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  Ran ran;
  if (pipe == nullptr) return ran;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    ran.out.append(buffer.data(), count);
  ran.status = ::pclose(pipe);
  return ran;
}

bool has_program(const std::string& name) { return shell("command -v " + name).status == 0; }

// Names of a list in --help: what stands first on lines that begin with two blanks.
std::vector<std::string> first_words(const std::string& help, const std::string& heading) {
  std::vector<std::string> words;
  std::istringstream lines(help.substr(std::min(help.find(heading), help.size())));
  std::string line;
  std::getline(lines, line);
  for (; std::getline(lines, line) && !line.empty();)
    if (line.size() > 2 && line[2] != ' ') words.push_back(line.substr(2, line.find(' ', 2) - 2));
  return words;
}

std::vector<std::string> verbs() { return first_words(rayfield({"--help"}).out, "Subcommands:"); }

// "-o", "--output" of every option that --help of a command shows.
std::vector<std::string> options_of(const std::string& verb) {
  std::vector<std::string> names;
  std::istringstream lines(rayfield({verb, "--help"}).out);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("  -", 0) != 0) continue;
    std::istringstream list(line.substr(2, line.find(' ', 2) - 2));
    for (std::string name; std::getline(list, name, ',');) names.push_back(name.substr(0, name.find('{')));
  }
  return names;
}

class Completion : public testing::Test {
 protected:
  // Words that bash offers for the last one of a command line.
  std::vector<std::string> offered(const std::vector<std::string>& words) {
    write_file(folder_.path("rayfield.bash"), rayfield({"completion", "bash"}).out);
    std::string script = "source " + folder_.path("rayfield.bash") + "\nCOMP_WORDS=(";
    for (const std::string& word : words) script += " '" + word + "'";
    script += ")\nCOMP_CWORD=" + std::to_string(words.size() - 1) + "\n_rayfield\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n";
    write_file(folder_.path("try.bash"), script);
    std::istringstream lines(shell("bash " + folder_.path("try.bash")).out);
    std::vector<std::string> list;
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) list.push_back(line);
    return list;
  }
  Folder folder_;
};

TEST_F(Completion, BashOffersCommandsOptionsAndWhatTheyMayBe) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(offered({"rayfield", "proc"}), Words{"process"});
  EXPECT_EQ(offered({"rayfield", "process", "--thr"}), Words{"--threads"});
  EXPECT_EQ(offered({"rayfield", "status", "--progress", "p"}), Words{"plain"});
  EXPECT_EQ(offered({"rayfield", "status", "--progress", "=", "p"}), Words{"plain"});
  EXPECT_EQ(offered({"rayfield", "export", "block", "--format", "flat"}), Words{"flatgeobuf"});
  EXPECT_EQ(offered({"rayfield", "export", "block", "--format", "png,geot"}),
            (Words{"png,geotiff", "png,geotiff-plain"}));
  EXPECT_EQ(offered({"rayfield", "completion", "f"}), Words{"fish"});
  EXPECT_EQ(offered({"rayfield", "registry", "ren"}), Words{"rename"});
  EXPECT_EQ(offered({"rayfield", "help", "sla"}), Words{"slam"});
  EXPECT_EQ(offered({"rayfield", "process", "my"}), Words{}) << "files are bash's own";
  EXPECT_EQ(offered({"rayfield", "process", "--threads", ""}), Words{}) << "nobody knows what number";
}

TEST_F(Completion, EveryCommandAndOptionOfTheHelpIsInAllShellsAndInTheManual) {
  const std::string manual = folder_.path("man");
  ASSERT_EQ(rayfield({"help", "--man", manual}).exit_code, 0);
  const std::string bash = rayfield({"completion", "bash"}).out, zsh = rayfield({"completion", "zsh"}).out,
                    fish = rayfield({"completion", "fish"}).out, program = read_file(manual + "/rayfield.1");
  ASSERT_GT(verbs().size(), 20U);
  for (const std::string& verb : verbs()) {
    EXPECT_THAT(offered({"rayfield", verb}), testing::Contains(verb));
    EXPECT_THAT(zsh, HasSubstr("'" + verb + ":"));
    EXPECT_THAT(fish, HasSubstr(" -a " + verb + " "));
    EXPECT_THAT(program, HasSubstr("rayfield\\-" + verb));
    const std::string page = read_file(manual + "/rayfield-" + verb + ".1");
    const std::vector<std::string> in_bash = offered({"rayfield", verb, "-"}), names = options_of(verb);
    ASSERT_GE(names.size(), 2U) << verb;
    for (const std::string& name : names) {
      EXPECT_THAT(in_bash, testing::Contains(name)) << verb;
      EXPECT_THAT(zsh, HasSubstr("'*" + name + "[")) << verb;
      const bool is_long = name.rfind("--", 0) == 0;
      EXPECT_THAT(fish, HasSubstr((is_long ? " -l " + name.substr(2) : " -s " + name.substr(1)) + " ")) << verb;
      std::string in_roff = "\\fB";
      for (const char c : name) in_roff += c == '-' ? std::string("\\-") : std::string(1, c);
      EXPECT_THAT(page, HasSubstr(in_roff + "\\fR")) << verb;
    }
  }
}

TEST_F(Completion, ScriptsAndPagesAreWellFormed) {
  const std::string manual = folder_.path("man");
  ASSERT_EQ(rayfield({"help", "--man", manual}).exit_code, 0);
  for (const auto& [name, check] :
       {std::pair{"groff", "groff -ww -man -Tutf8 -z "}, {"mandoc", "mandoc -Tlint -Wwarning "}}) {
    if (!has_program(name)) continue;
    EXPECT_EQ(shell(check + manual + "/*.1").out, "") << name;
  }
  for (const auto& [name, check] :
       {std::pair{"bash", "bash -n "}, {"zsh", "zsh -n "}, {"fish", "fish --no-execute "}}) {
    if (!has_program(name)) continue;
    write_file(folder_.path(name), rayfield({"completion", name}).out);
    EXPECT_EQ(shell(check + folder_.path(name)).out, "") << name;
  }
}

}  // namespace
}  // namespace rayfield::test
