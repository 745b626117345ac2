#!/usr/bin/env bash
# tests/source_rules finds what breaks each rule, and nothing else.
set -euo pipefail
rules=$(dirname "$(readlink -f "$0")")/../source_rules
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/common/{base,robot,control,trajectory,environment,messages,time,runtime} "$tree"/idl "$tree"/services/{plant,environment,trajectory,controller} "$tree"/tests

: >"$tree/common/base/elementary.hpp"
: >"$tree/common/control/law.hpp"
cat >"$tree/common/control/sound.cpp" <<'END'
#include <Eigen/Core>
#include <cmath>
#include "base/elementary.hpp"
#include "law.hpp"
// sin(x) and std::pow(x, 2) in a comment
double f(double x) { return baton::elementary::sin(x) + std::sqrt(x) + std::abs(x) + std::remainder(x, 2.0); }
END
cat >"$tree/services/plant/sound.cpp" <<'END'
  print("a line that is put together of two "
        "parts\n",
        1);
END
"$rules" "$tree" || { echo "a sound tree is refused" && exit 1; }

# expectBreach FILE TEXT [LINE]: one breach, in that file, at its first line unless said.
expectBreach() {
  local said
  mkdir -p "$(dirname "$tree/$1")"
  printf '%s\n' "$2" >"$tree/$1"
  if said=$("$rules" "$tree"); then echo "not found: $2" && exit 1; fi
  [[ $(grep -c "^$1:${3:-1}:" <<<"$said") == 1 ]] || { printf 'expected %s:%s, found:\n%s\n' "$1" "${3:-1}" "$said" && exit 1; }
  rm "$tree/$1"
}
expectBreach common/robot/x.hpp '#include <yaml-cpp/yaml.h>'
expectBreach common/robot/x.hpp '#include <boost/asio/io_context.hpp>'
expectBreach common/base/x.hpp '#include <sleef.h>'
expectBreach common/robot/x.hpp '#include "sleef.h"'
expectBreach common/robot/x.hpp '#include "yaml-cpp/yaml.h"'
expectBreach common/mcap/x.cpp '#include "../time/pacer.hpp"'
expectBreach common/mcap/x.cpp '#include "base/../time/pacer.hpp"'
expectBreach idl/include/x.hpp '#include <../common/time/pacer.hpp>'
expectBreach common/control/laws/x.cpp 'double y = std::sin(1.0);'
expectBreach common/trajectory/x.cpp 'double y = cosf(1.0F);'
expectBreach common/environment/x.cpp 'double y = std::pow(x, 3) + elementary::sin(x);'
expectBreach common/robot/x.cpp 'Matrix3 R = Eigen::AngleAxisd(1.0, axis).toRotationMatrix();'
expectBreach common/control/x.cpp 'double y = x.array().exp().sum();'
expectBreach common/control/x.cpp 'auto y = x.unaryExpr(&std::sin);'
expectBreach common/control/x.cpp 'double y = __builtin_exp(x);'
expectBreach common/messages/x.cpp 'const Eigen::AngleAxisd turn(q);'
expectBreach common/runtime/x.cpp 'double y = std::pow(10.0, n);'
expectBreach common/trajectory/x.cpp 'std::normal_distribution<double> noise;'
expectBreach services/plant/x.cpp 'double y = std::hypot(a, b);'
expectBreach services/plant/x.cpp '#include <fastdds/dds/domain/DomainParticipant.hpp>'
expectBreach services/recorder/x.cpp 'const auto now = std::chrono::system_clock::now();'
expectBreach services/plant/x.cpp 'std::printf("%s", name);'
expectBreach common/runtime/x.cpp 'std::cerr << name;'
expectBreach services/plant/x.cpp $'  "What is said here goes on "\n  "and\\n"\n  "ends."' 2
echo "every breach is found"
