// Fuzz target: the JSON that a recording carries (its certificate, and what a copy keeps of the original's), as
// `bag verify` and the reports read it.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "bag/verify.hpp"
#include "base/error.hpp"
#include "report/recording.hpp"
#include "support/small_recording.hpp"

namespace {

using namespace baton;

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = ::memfd_create("fuzz", 0);
  require(file >= 0);
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  {
    test::SmallRecording recording(path);
    msg::Event event;
    recording.add(dds::topics::kEvent, "plant", event);
    recording.attach("certificate.json", {reinterpret_cast<const char*>(data), size});
    recording.close();
  }
  try {
    const Verification found = verifyRecording({path}, [](double) {});
    require(found.messages == 1 && found.damage.empty());
    require(found.verdict() != RecordingVerdict::kComplete);  // no manifest says what the plant sent
  } catch (const Error&) {
  }
  ::close(file);
  return 0;
}
