/* The keys' folder of a team that publishes one of several temples on a museum's server
 * (docs/tuf.md, Several temples on one server). */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_TEAM_H
#define GOPURA_PIPELINE_KEYS_KEYS_TEAM_H

#include "base/compiler.h"

/* Makes it, or brings it up to date with what the museum hands over: a folder that has tuf/ of its
 * keys and, where teams sign these files themselves, snapshot.key and timestamp.key. All of that is
 * copied. Made, if missing, are ROLE.key, the team's private key, with ROLE.pub, the public one in
 * PEM, which the museum needs; and signing.ini, which says who signs.
 *
 * -EEXIST: the folder has other keys, or follows another museum; -ENOENT: the museum's root is
 * missing; -EPERM, -EBADMSG: a key is damaged or others may read it. Errors are logged. */
must_check int keys_make_team(const char *folder, const char *role, const char *handed_over);

#endif
