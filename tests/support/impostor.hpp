/// What the public settings of the DDS product give anybody on the machine: to see what participants say of themselves,
/// and to come under the GUID prefix of one of them with its words.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "dds/fastdds.hpp"
#include "dds/qos.hpp"
#include "dds/raw_type.hpp"
#include "dds/typed.hpp"

namespace baton::test {

/// What a participant says of itself.
struct Words {
  dds::GuidPrefix prefix{};
  std::string user_data;
};

class Impostor final : fastdds::DiscoveryListener {
 public:
  /// Only looks.
  Impostor(int domain, std::function<void()> on_seen) : on_seen_(std::move(on_seen)) { enter(domain, {}, ""); }
  /// @param as  whose prefix and words it takes.
  Impostor(int domain, const Words& as, const std::string& partition) { enter(domain, as, partition); }
  ~Impostor() override {
    participant_->set_listener(nullptr);
    participant_->delete_contained_entities();
    fastdds::dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Impostor(const Impostor&) = delete;
  Impostor& operator=(const Impostor&) = delete;

  /// The words of one that was seen, also after it has left.
  template <class IsWanted>
  [[nodiscard]] std::optional<Words> wordsOf(const IsWanted& is_wanted) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(seen_, is_wanted);
    return found == seen_.end() ? std::nullopt : std::optional(*found);
  }

  /// On a writer that is made when it is first used: what comes before it is matched is heard by nobody. Returns how
  /// many readers it has.
  template <class T>
  int say(const dds::Topic<T>& topic, const T& message) {
    fastdds::dds::DataWriter*& writer = writers_[topic.name];
    if (writer == nullptr) {
      // Who knew the one whose place it takes has heard of as many endpoints already, by number, and ignores the first.
      for (int i = 0; writers_.size() == 1 && i < 64; ++i) make("other-" + std::to_string(i), "Other", topic.profile);
      writer = make(topic.name, topic.type, topic.profile, dds::endpointOptions(topic).max_payload);
    }
    std::vector<std::byte> room(dds::maxPayload<T>());
    dds::RawType::Outgoing outgoing{dds::encode(message, std::span(room))};
    fastdds::rtps::WriteParams params;
    writer->write(&outgoing, params);
    fastdds::dds::PublicationMatchedStatus matched;
    writer->get_publication_matched_status(matched);
    return matched.current_count;
  }

 private:
  void enter(int domain, const std::optional<Words>& as, const std::string& partition) {
    auto qos = fastdds::dds::DomainParticipantFactory::get_instance()->get_default_participant_qos();
    const auto udp = std::make_shared<fastdds::transport::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    fastdds::propagateNoTypes(qos);
    participant_ = fastdds::createParticipant(
        domain, qos, this, [&](fastdds::rtps::GuidPrefix_t& prefix, fastdds::dds::DomainParticipantQos& changed) {
          if (!as) return;
          std::ranges::copy(as->prefix, prefix.value);
          changed.user_data().data_vec({as->user_data.begin(), as->user_data.end()});
        });
    if (participant_ == nullptr) throw std::runtime_error("DDS makes no such participant");
    auto publisher_qos = participant_->get_default_publisher_qos();
    if (!partition.empty()) publisher_qos.partition().push_back(partition.c_str());
    publisher_ = participant_->create_publisher(publisher_qos);
  }
  fastdds::dds::DataWriter* make(const std::string& name, const std::string& type_name, dds::Profile profile,
                                 std::uint32_t max_payload = 64) {
    fastdds::dds::TypeSupport type(new dds::RawType(type_name, max_payload, false));
    type.register_type(participant_);
    fastdds::dds::DataWriterQos qos = publisher_->get_default_datawriter_qos();
    dds::applyProfile(profile, qos);
    return publisher_->create_datawriter(
        participant_->create_topic(name, type_name, participant_->get_default_topic_qos()), qos);
  }
  void onParticipant(const fastdds::ParticipantData& data) override {
    {
      const std::lock_guard lock(mutex_);
      Words& words = seen_.emplace_back();
      std::copy_n(data.guid.guidPrefix.value, words.prefix.size(), words.prefix.begin());
      words.user_data.assign(data.user_data.begin(), data.user_data.end());
    }
    if (on_seen_) on_seen_();
  }
  void onParticipantGone(const fastdds::rtps::GUID_t&) override {}
  void onWriter(const fastdds::PublicationData&) override {}
  void onWriterGone(const fastdds::rtps::GUID_t&) override {}

  std::function<void()> on_seen_;
  mutable std::mutex mutex_;
  std::vector<Words> seen_;
  fastdds::dds::DomainParticipant* participant_ = nullptr;
  fastdds::dds::Publisher* publisher_ = nullptr;
  std::map<std::string, fastdds::dds::DataWriter*> writers_;
};

}  // namespace baton::test
