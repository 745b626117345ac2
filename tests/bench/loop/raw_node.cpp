#include "raw_node.hpp"

#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace raw {
namespace {
using namespace baton::fastdds::dds;
namespace transport = baton::fastdds::transport;

constexpr int kDepth = 1024;
constexpr int kSocketBuffer = 4 << 20;

DomainParticipantQos participantQos(bool shared_memory) {
  DomainParticipantQos qos = DomainParticipantFactory::get_instance()->get_default_participant_qos();
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {"127.0.0.1"};
  udp->sendBufferSize = kSocketBuffer;
  udp->receiveBufferSize = kSocketBuffer;
  qos.transport().user_transports.push_back(udp);
  if (shared_memory) {
    qos.transport().user_transports.push_back(std::make_shared<transport::SharedMemTransportDescriptor>());
  }
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration_announcementperiod = {0, 100'000'000};
  discovery.leaseDuration = {3600, 0};
  discovery.initial_announcements.count = 5;
  discovery.initial_announcements.period = {0, 20'000'000};
  return qos;
}

template <class Qos>
void setLoopQos(Qos& qos) {
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = kDepth;
  qos.resource_limits().max_samples = kDepth + 1;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = kDepth + 1;
  qos.resource_limits().allocated_samples = 64;
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = baton::fastdds::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

template <class Entity>
Entity* made(Entity* entity, const std::string& what) {
  if (entity == nullptr) throw std::runtime_error("DDS could not create " + what);
  return entity;
}

}  // namespace

Node::Node(const Network& network) {
  participant_ = made(DomainParticipantFactory::get_instance()->create_participant(
                          network.domain, participantQos(network.shared_memory)),
                      "a participant in domain " + std::to_string(network.domain));
  PublisherQos publisher_qos = participant_->get_default_publisher_qos();
  SubscriberQos subscriber_qos = participant_->get_default_subscriber_qos();
  publisher_qos.partition().push_back(network.partition.c_str());
  subscriber_qos.partition().push_back(network.partition.c_str());
  publisher_ = made(participant_->create_publisher(publisher_qos), "a publisher");
  subscriber_ = made(participant_->create_subscriber(subscriber_qos), "a subscriber");
}

Node::~Node() {
  for (DataReader* reader : readers_) reader->set_listener(nullptr);
  for (const auto& [writer, readers] : writers_) {
    // While Fast DDS 2.9.1 deletes a writer that holds samples, a heartbeat that looks at them may never end.
    std::size_t removed = 0;
    writer->clear_history(&removed);
  }
  participant_->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

Topic* Node::createTopic(const TypeSupport& type, const std::string& name) {
  type.register_type(participant_);
  return made(participant_->create_topic(name, type.get_type_name(), participant_->get_default_topic_qos()),
              "topic " + name);
}

DataWriter* Node::createWriter(const TypeSupport& type, const std::string& topic) {
  DataWriterQos qos = publisher_->get_default_datawriter_qos();
  setLoopQos(qos);
  qos.publish_mode().kind = SYNCHRONOUS_PUBLISH_MODE;
  const auto times = baton::fastdds::timesOf(qos);
  times.heartbeat_period = {0, 20'000'000};
  times.nack_response_delay = {0, 0};
  times.nack_suppression_duration = {0, 10'000'000};
  qos.reliable_writer_qos().disable_heartbeat_piggyback = true;
  return made(publisher_->create_datawriter(createTopic(type, topic), qos), "a writer on " + topic);
}

DataReader* Node::createReader(const TypeSupport& type, const std::string& topic, DataReaderListener* listener) {
  DataReaderQos qos = subscriber_->get_default_datareader_qos();
  setLoopQos(qos);
  const auto times = baton::fastdds::timesOf(qos);
  times.initial_acknack_delay = {0, 5'000'000};
  times.heartbeat_response_delay = {0, 1'000'000};
  return made(subscriber_->create_datareader(createTopic(type, topic), qos, listener, StatusMask::data_available()),
              "a reader on " + topic);
}

void Node::awaitMatches() const {
  const auto areAll = [&] {
    return std::all_of(readers_.begin(), readers_.end(),
                       [](DataReader* reader) {
                         SubscriptionMatchedStatus status;
                         reader->get_subscription_matched_status(status);
                         return status.current_count == 1;
                       }) &&
           std::all_of(writers_.begin(), writers_.end(), [](const auto& writer) {
             PublicationMatchedStatus status;
             writer.first->get_publication_matched_status(status);
             return status.current_count == writer.second;
           });
  };
  while (!areAll()) usleep(1'000);  // before the first step; nothing is polled afterwards
}

}  // namespace raw
