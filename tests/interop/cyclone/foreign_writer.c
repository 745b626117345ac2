/* A process of another vendor's DDS (Eclipse Cyclone DDS), as a test needs one in a cell: publishes one of Baton's
 * types and one that Baton does not know, both reliably, once somebody reads them.
 *
 *   foreign_writer DOMAIN PARTITION COUNT
 */
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>

#include "foreign.h"
#include "loop.h"

static const char kConfig[] =
    "<CycloneDDS><Domain>"
    "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces></General>"
    "<Internal><GenerateKeyhash>true</GenerateKeyhash></Internal>"
    "</Domain></CycloneDDS>";

static dds_entity_t made(dds_entity_t entity, const char* what) {
  if (entity >= 0) return entity;
  fprintf(stderr, "foreign_writer: cannot create %s: %s\n", what, dds_strretcode(-entity));
  exit(1);
}

static void waitForReader(dds_entity_t writer) {
  dds_publication_matched_status_t status;
  for (int waited_ms = 0; waited_ms < 60000; waited_ms += 10) {
    if (dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK && status.current_count > 0) return;
    dds_sleepfor(DDS_MSECS(10));
  }
  fprintf(stderr, "foreign_writer: nobody reads\n");
  exit(1);
}

int main(int argc, char** argv) {
  if (argc != 4) {
    fprintf(stderr, "usage: foreign_writer DOMAIN PARTITION COUNT\n");
    return 2;
  }
  setenv("CYCLONEDDS_URI", kConfig, 1);
  const dds_entity_t participant =
      made(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  const char* partitions[] = {argv[2]};
  dds_qset_partition(qos, 1, partitions);
  const dds_entity_t publisher = made(dds_create_publisher(participant, qos, NULL), "publisher");
  dds_delete_qos(qos);

  qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t contacts =
      made(dds_create_writer(
               publisher,
               made(dds_create_topic(participant, &baton_msg_Contact_desc, "felt_elsewhere", NULL, NULL), "topic"), qos,
               NULL),
           "writer");
  const dds_entity_t beacons =
      made(dds_create_writer(publisher,
                             made(dds_create_topic(participant, &foreign_Beacon_desc, "beacon", NULL, NULL), "topic"),
                             qos, NULL),
           "writer");
  dds_delete_qos(qos);
  waitForReader(contacts);
  waitForReader(beacons);

  const int count = atoi(argv[3]);
  double values[] = {0.5, 1.5};
  for (int i = 0; i < count; ++i) {
    baton_msg_Contact contact = {0};
    contact.step = (uint64_t)i;
    contact.time_ns = 1000 * i;
    foreign_Beacon beacon = {0};
    beacon.count = (uint64_t)i;
    snprintf(beacon.text, sizeof beacon.text, "beacon %d", i);
    beacon.values._length = beacon.values._maximum = 2;
    beacon.values._buffer = values;
    if (dds_write(contacts, &contact) != DDS_RETCODE_OK || dds_write(beacons, &beacon) != DDS_RETCODE_OK) {
      fprintf(stderr, "foreign_writer: a sample is refused\n");
      return 1;
    }
  }
  if (dds_wait_for_acks(contacts, DDS_SECS(60)) != DDS_RETCODE_OK ||
      dds_wait_for_acks(beacons, DDS_SECS(60)) != DDS_RETCODE_OK) {
    fprintf(stderr, "foreign_writer: not all is acknowledged\n");
    return 1;
  }
  dds_delete(participant);
  return 0;
}
