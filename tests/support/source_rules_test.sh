#!/usr/bin/env bash
# tests/source_rules finds what breaks each rule, and nothing else.
set -euo pipefail
rules=$(dirname "$(readlink -f "$0")")/../source_rules
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/common/{base,robot,control,trajectory,environment} "$tree"/services/{plant,environment,trajectory,controller}

cat >"$tree/common/control/sound.cpp" <<'END'
#include <Eigen/Core>
#include <cmath>
#include "base/elementary.hpp"
// sin(x) and std::pow(x, 2) in a comment
double f(double x) { return baton::elementary::sin(x) + std::sqrt(x) + std::abs(x) + std::remainder(x, 2.0); }
END
"$rules" "$tree" || { echo "a sound tree is refused" && exit 1; }

# expectBreach FILE LINE: one breach, in that file.
expectBreach() {
  local said
  mkdir -p "$(dirname "$tree/$1")"
  printf '%s\n' "$2" >"$tree/$1"
  if said=$("$rules" "$tree"); then echo "not found: $2" && exit 1; fi
  [[ $(grep -c "^$1:1:" <<<"$said") == 1 ]] || { printf 'expected %s:1, found:\n%s\n' "$1" "$said" && exit 1; }
  rm "$tree/$1"
}
expectBreach common/robot/x.hpp '#include <yaml-cpp/yaml.h>'
expectBreach common/robot/x.hpp '#include <boost/asio/io_context.hpp>'
expectBreach common/base/x.hpp '#include <sleef.h>'
expectBreach common/mcap/x.cpp '#include "../time/pacer.hpp"'
expectBreach common/control/laws/x.cpp 'double y = std::sin(1.0);'
expectBreach common/trajectory/x.cpp 'double y = cosf(1.0F);'
expectBreach common/environment/x.cpp 'double y = std::pow(x, 3) + elementary::sin(x);'
expectBreach common/robot/x.cpp 'Matrix3 R = Eigen::AngleAxisd(1.0, axis).toRotationMatrix();'
expectBreach common/control/x.cpp 'double y = x.array().exp().sum();'
expectBreach services/plant/x.cpp 'double y = std::hypot(a, b);'
expectBreach services/recorder/x.cpp 'const auto now = std::chrono::system_clock::now();'
echo "every breach is found"
