/// What `bag recover`, `merge` and `cut` have in common: the file they make.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "mcap/copy.hpp"

namespace baton {

struct CopyTarget {
  std::string file;
  bool overwrite = false;
};

/// --overwrite.
void addOverwrite(CLI::App& command, CopyTarget& target);

/// Of recordings and then the file to make, the file; `given` keeps the recordings. Throws UsageError when there is
/// only one name.
[[nodiscard]] std::string takeLast(std::vector<std::string>& given);

/// How the file is written. Throws UsageError when it is one of those that are read, and
/// UnavailableError when it is there and is not to be replaced.
[[nodiscard]] mcap::WriterOptions optionsFor(const CopyTarget& target, const std::vector<std::string>& inputs);

/// Says on standard error that a recording is used as far as it goes, and where it contradicts itself.
void sayHowItIs(const std::string& file, const mcap::FileInfo& info);
/// Opens a recording that is to be copied; says on standard error when it is not whole. Throws what Reader throws.
[[nodiscard]] std::unique_ptr<mcap::Reader> openForCopy(const std::string& file);

/// The name of a metadata record or an attachment in a copy that is not the whole: its certificate, and the count of
/// what the file begins with from before, hold for the original, and are called so.
[[nodiscard]] std::string withoutClaim(const std::string& name);

}  // namespace baton
