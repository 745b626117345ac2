/// Where things are on this machine: programs, data and the folder of runs. They find each other by their places, so a
/// build and an installation can be moved as a whole:
///
///   a build          bin/{baton,baton-plant,...}                      share/baton/{scenarios,robots,...}
///   an installation  bin/baton   libexec/baton/{baton-plant,...}      share/baton/{scenarios,robots,...}
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace baton {

/// $BATON_HOME, else $XDG_STATE_HOME/baton, else ~/.local/state/baton. Created when missing.
/// Throws UnavailableError when none of the variables is set or the folder cannot be made.
[[nodiscard]] std::filesystem::path stateFolder();

/// The folder this program's executable is in.
[[nodiscard]] std::filesystem::path programFolder();

/// Whether this program is of an installation, where people type `baton`; in a checkout they type deploy/baton.
[[nodiscard]] bool isInstalled();

/// Another of Baton's programs, such as "baton-plant". Throws UnavailableError when it is not there.
[[nodiscard]] std::filesystem::path siblingProgram(const std::string& name);

/// The folder of scenarios/ and robots/. Throws UnavailableError when it is not there.
[[nodiscard]] std::filesystem::path dataFolder();

/// A scenario as a person names it: a path, or the bare name of one in dataFolder()/scenarios. Throws UsageError
/// listing what there is.
[[nodiscard]] std::filesystem::path findScenario(const std::string& name);
/// Likewise a robot, in dataFolder()/robots.
[[nodiscard]] std::filesystem::path findRobot(const std::string& name);

/// Empty for a file; else what is there: "a folder", "nothing", "a device, a pipe or a socket", or the system's reason.
[[nodiscard]] std::string whyNoFile(const std::filesystem::path& path);

/// The absolute path of a file to be made, as a person names it with --out. Throws UsageError when its folder is not
/// there.
[[nodiscard]] std::filesystem::path outputPath(const std::string& out);

/// Makes a folder and those above it. Throws UnavailableError, saying which and why, when that cannot be.
void makeFolder(const std::filesystem::path& folder);

/// "20261122-031512-4f2a": sorts by time, newer runs after older ones.
[[nodiscard]] std::string newRunId();

/// The whole of a file. Throws UnavailableError, with the system's reason, when it cannot be read.
[[nodiscard]] std::string readFile(const std::filesystem::path& path);
/// Its first bytes, at most so many. @param[out] error  0, or errno: then nothing is returned.
[[nodiscard]] std::string readFile(const std::filesystem::path& path, std::size_t most_bytes, int& error);

/// Makes or replaces a file: whoever reads it meanwhile sees the old one whole. Throws UnavailableError, with the
/// system's reason, when that cannot be.
void writeFile(const std::filesystem::path& path, std::string_view text);

/// What is in a folder, nothing when there is no such folder. Throws UnavailableError when it cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> listFolder(const std::filesystem::path& folder);

}  // namespace baton
