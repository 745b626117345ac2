/// Which interfaces a participant uses, and that one on all of them meets those on the loopback.
#include "dds/interfaces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "dds/endpoint.hpp"
#include "loopback.hpp"

namespace baton::dds {
namespace {

using test::Inbox;
using test::memberOptions;
using test::Signal;
using Strings = std::vector<std::string>;

const std::vector<Interface> kMachine{{"lo", "127.0.0.1"}, {"eth0", "192.0.2.2"}, {"eth0", "192.0.2.3"}};

TEST(Interfaces, AreNamedByNameOrAddress) {
  EXPECT_EQ(addressesOf({}, kMachine), Strings{}) << "all of them";
  EXPECT_EQ(addressesOf({"lo", "all"}, kMachine), Strings{});
  EXPECT_EQ(addressesOf({"lo"}, kMachine), Strings{"127.0.0.1"});
  EXPECT_EQ(addressesOf({"192.0.2.3", "lo"}, kMachine), (Strings{"192.0.2.3", "127.0.0.1"}));
  EXPECT_EQ(addressesOf({"eth0"}, kMachine), (Strings{"192.0.2.2", "192.0.2.3"}));
}

TEST(Interfaces, WhatIsNotThereIsRefusedWithWhatIs) {
  try {
    (void)addressesOf({"wlan0"}, kMachine);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("lo (127.0.0.1), eth0 (192.0.2.2)"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("found wlan0"), std::string::npos) << error.what();
  }
}

TEST(Interfaces, TheLoopbackIsItsAddressAloneWhateverElseItHasAndIsNotLookedUp) {
  std::vector<Interface> there = kMachine;
  there.insert(there.begin(), {"lo", "127.0.0.53"});
  EXPECT_EQ(addressesOf({kLoopback}, there), Strings{"127.0.0.1"});
  EXPECT_EQ(addressesOf({kLoopback}, {}), Strings{"127.0.0.1"});
}

TEST(Interfaces, AMachineWithoutAnyIsUnavailableWhateverIsAskedFor) {
  EXPECT_NO_THROW(expectUp({}, kMachine));
  EXPECT_NO_THROW(expectUp({"192.0.2.99", "192.0.2.2"}, kMachine)) << "one is enough";
  EXPECT_THROW(expectUp({}, {}), UnavailableError);
  EXPECT_THROW((void)addressesOf({"eth0"}, {}), UnavailableError);
  try {
    expectUp({kLoopback, "192.0.2.99"}, {{"eth0", "192.0.2.2"}});
    FAIL();
  } catch (const UnavailableError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("expected an interface with the address 127.0.0.1 or 192.0.2.99"), std::string::npos) << text;
    EXPECT_NE(text.find("found eth0 (192.0.2.2)"), std::string::npos) << text;
  }
}

TEST(Interfaces, AParticipantWithoutANetworkIsRefused) {
  ParticipantOptions nowhere = memberOptions("nowhere", "cell");
  nowhere.addresses = {"192.0.2.99"};  // of documentation: no machine has it
  EXPECT_THROW(Participant{nowhere}, UnavailableError);
}

TEST(Interfaces, ThisMachineHasTheLoopback) {
  const std::vector<Interface> there = interfaces();
  EXPECT_TRUE(std::ranges::any_of(there, [](const Interface& one) { return one.address == "127.0.0.1"; }));
}

TEST(Interfaces, AReaderOnAllOfThemInAllPartitionsHearsWritersOnTheLoopback) {
  Signal signal;
  Inbox inbox(signal);
  ParticipantOptions everywhere = memberOptions("everywhere", "");
  everywhere.partition = "*";
  everywhere.also_read = {""};
  everywhere.addresses = {};
  everywhere.cell = "";  // as `record traffic` does it
  Participant guest(everywhere);
  ParticipantOptions without = memberOptions("without", "");
  without.partition = "";
  Participant plain(without), member(memberOptions("member", "cell"));
  const EndpointOptions options{.topic = "everywhere" + test::testPartition(""), .type = "baton::test::Raw"};
  RawReader reader(
      guest, options, [&](const RawSample& sample) { inbox.put(sample); }, [&] { signal.notify(); });
  RawWriter of_none(plain, options, [&] { signal.notify(); }), of_cell(member, options, [&] { signal.notify(); });
  ASSERT_TRUE(signal.waitUntil(
      [&] { return reader.matched().size() == 2 && !of_none.matched().empty() && !of_cell.matched().empty(); }));
  const std::array<std::byte, 8> payload{};
  ASSERT_TRUE(of_none.write(payload) && of_cell.write(payload));
  EXPECT_TRUE(signal.waitUntil([&] { return inbox.size() == 2; }));
}

}  // namespace
}  // namespace baton::dds
