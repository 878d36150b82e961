/* Parses urls with libcurl's url interface and compares hosts and ports, to decide whether a
 * redirection may be followed. */
#include "net/redirect.h"

#include <ctype.h>
#include <curl/curl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { HOST_BYTES = 256 };

struct place {
	bool secret;                             /* true for https */
	char host[HOST_BYTES], user[HOST_BYTES]; /* user is "" if the url has none */
	unsigned port;
};

/* ---- list of allowed hosts */

/* Cuts the next host off the list; NULL at the end. */
static char *next_host(char **list)
{
	return strtok_r(NULL, ", ", list);
}

/* Cuts ":port" off the host. *port is 0 if there is none. Returns false for an invalid port. */
static bool cut_port(char *host, unsigned *port)
{
	char *colon = strchr(host, ':'), *end;
	unsigned long value;

	*port = 0;
	if (!colon)
		return true;
	*colon = '\0';
	value = strtoul(colon + 1, &end, 10);
	*port = (unsigned)value;
	return isdigit((unsigned char)colon[1]) && *end == '\0' && value > 0 && value < 65536;
}

bool redirect_hosts_valid(const char *hosts)
{
	char copy[REDIRECT_HOSTS_BYTES], *left = copy, *host;
	unsigned port, count = 0;

	if (!hosts)
		return true;
	if (strlen(hosts) >= sizeof(copy))
		return false;
	memcpy(copy, hosts, strlen(hosts) + 1);
	while ((host = next_host(&left))) {
		if (!cut_port(host, &port) || !isalnum((unsigned char)host[0]) ||
		    strlen(host) >= HOST_BYTES || ++count > REDIRECT_HOSTS_MAX)
			return false;
		for (const char *c = host; *c; c++)
			if (!isalnum((unsigned char)*c) && *c != '-' && *c != '.')
				return false;
	}
	return true;
}

static bool is_named(const struct place *place, const char *hosts)
{
	char copy[REDIRECT_HOSTS_BYTES], *left = copy, *host;
	unsigned port;

	snprintf(copy, sizeof(copy), "%s", hosts ? hosts : "");
	while ((host = next_host(&left)))
		if (cut_port(host, &port) && strcasecmp(host, place->host) == 0 &&
		    place->port == (port            ? port
				    : place->secret ? 443
						    : 80))
			return true;
	return false;
}

/* ---- urls */

static bool get_part(CURLU *url, CURLUPart part, char *out, size_t bytes)
{
	char *text = NULL;
	bool fits;

	if (curl_url_get(url, part, &text, CURLU_DEFAULT_PORT) != CURLUE_OK)
		return false;
	fits = strlen(text) < bytes;
	if (fits)
		memcpy(out, text, strlen(text) + 1);
	curl_free(text);
	return fits;
}

/* Returns false if text is not an http or https url. */
static bool parse(struct place *out, const char *text)
{
	CURLU *url = curl_url();
	char scheme[16], port[16];
	bool good;

	if (!url)
		return false;
	good = curl_url_set(url, CURLUPART_URL, text, 0) == CURLUE_OK &&
	       get_part(url, CURLUPART_SCHEME, scheme, sizeof(scheme)) &&
	       get_part(url, CURLUPART_HOST, out->host, sizeof(out->host)) &&
	       get_part(url, CURLUPART_PORT, port, sizeof(port));
	if (good) {
		if (!get_part(url, CURLUPART_USER, out->user, sizeof(out->user)))
			out->user[0] = '\0';
		out->secret = strcasecmp(scheme, "https") == 0;
		out->port = (unsigned)strtoul(port, NULL, 10);
		good = out->secret || strcasecmp(scheme, "http") == 0;
	}
	curl_url_cleanup(url);
	return good;
}

bool redirect_allowed(const char *server, const char *from, const char *to, const char *hosts)
{
	struct place home, now, next;

	if (!parse(&home, server) || !parse(&now, from) || !parse(&next, to))
		return false;
	if (!next.secret && (home.secret || now.secret))
		return false;
	if (next.user[0] && strcmp(next.user, home.user) != 0) /* "museum.example@evil.example" */
		return false;
	if (strcasecmp(next.host, home.host) == 0 &&
	    (next.port == home.port || (next.secret && !home.secret && next.port == 443)))
		return true;
	return is_named(&next, hosts);
}
