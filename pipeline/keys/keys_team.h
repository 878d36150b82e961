/* The keys' folder of a team that publishes one of several temples on a museum's server
 * (docs/tuf.md, Several temples on one server). */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_TEAM_H
#define GOPURA_PIPELINE_KEYS_KEYS_TEAM_H

#include "base/compiler.h"

/* Makes it, or brings it up to date with what the museum hands over, a folder that has tuf/ of its
 * keys and, where teams sign these files themselves, snapshot.key and timestamp.key:
 *
 *   ROLE.key ROLE.pub   made here, if missing: the private key, and the public one in PEM, which
 * the museum needs tuf/N.root.json snapshot.key timestamp.key    copied signing.ini         made
 * here, if missing: who signs
 *
 * -EEXIST: the folder has other keys, or follows another museum; -ENOENT: the museum's root is
 * missing; -EPERM, -EBADMSG: a key is damaged or others may read it. Errors are logged. */
must_check int keys_make_team(const char *folder, const char *role, const char *handed_over);

#endif
