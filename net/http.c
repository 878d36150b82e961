/* HTTP requests with libcurl's multi interface, driven by an epoll descriptor and a timer. It
 * checks ranges, sizes and redirections of each answer, and counts received bytes. */
#include "net/http.h"

#include <curl/curl.h>
#include <errno.h>
#include <limits.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "base/log.h"
#include "net/redirect.h"

enum {
	URL_BYTES_MAX = 4096,
	ETAG_BYTES_MAX = 128,
	CONNECT_MS = 8000,
	DEAD_MS = 30000, /* without an acknowledgement a connection is dead */
	STALL_S = 15,
	STALL_BYTES_PER_S = 64,
	PATIENCE_S = 60,
	/* minimum average rate of a whole request; anything slower is treated as an attack */
	TRICKLE_BYTES_PER_S = 1024,
	TRICKLE_S_MAX = 900,
	HEADER_BYTES_MAX = 64 * 1024, /* all headers of one answer together */
	/* read to its end, so that the connection can be reused */
	ERROR_BODY_BYTES_MAX = 64 * 1024,
	CONNECTIONS_MAX = 8, /* with HTTP/1.1; HTTP/2 needs one */
	SOCKETS_MAX = 64,
	EVENTS = 16,
};

struct http {
	CURLM *multi;
	int epoll_fd, timer_fd;
	char url[URL_BYTES_MAX];
	char folder[PATH_MAX]; /* the folder as given, if the server is local */
	char *ca_file, *redirect_hosts;
	long stall_s, patience_s;
	bool is_local;
	bool is_stalled;          /* the last request was not answered in time */
	int sockets[SOCKETS_MAX]; /* open sockets, to count the bytes they received */
	size_t socket_count;
	/* received by sockets that were closed, and read from a local folder */
	uint64_t received_bytes;
};

struct http_request {
	struct http *http;
	CURL *easy;
	struct curl_slist *headers;
	struct http_get get;
	char etag[ETAG_BYTES_MAX]; /* of the answer */
	char error[CURL_ERROR_SIZE];
	long status; /* known once the body begins; 0 before that and for a local folder */
	bool body_began;
	bool range_is_right;   /* the answer's Content-Range begins where we asked */
	uint32_t redirects;    /* followed so far */
	bool went_astray;      /* the last redirection was not allowed or failed */
	uint64_t header_bytes; /* of the answer */
	bool enough, refused;  /* why the body was cut short */
	uint64_t skip;         /* bytes of a whole file that precede those we asked for */
	uint64_t passed;       /* bytes passed to the receiver */
	uint64_t ignored;      /* bytes of an error page */
};

/* ---- sockets: bytes received, as counted by the kernel */

static uint64_t received_by(int fd)
{
	struct tcp_info info = { 0 };
	socklen_t size = sizeof(info);

	if (getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) < 0)
		return 0;
	return info.tcpi_bytes_received;
}

static curl_socket_t on_open(void *data, curlsocktype purpose, struct curl_sockaddr *address)
{
	struct http *http = data;
	const unsigned dead_ms = DEAD_MS;
	int fd = socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);

	(void)purpose;
	/* Without this the kernel takes a quarter of an hour to find out that nobody is at the
	 * other end. */
	if (fd >= 0 && setsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &dead_ms, sizeof(dead_ms)) < 0)
		log_debug("net", "a dead connection will not be noticed");
	if (fd >= 0 && http->socket_count < SOCKETS_MAX)
		http->sockets[http->socket_count++] = fd;
	return fd < 0 ? CURL_SOCKET_BAD : fd;
}

static int on_close(void *data, curl_socket_t fd)
{
	struct http *http = data;

	for (size_t i = 0; i < http->socket_count; i++) {
		if (http->sockets[i] != fd)
			continue;
		http->received_bytes += received_by(fd);
		http->sockets[i] = http->sockets[--http->socket_count];
		break;
	}
	return close(fd);
}

uint64_t http_received_bytes(const struct http *http)
{
	uint64_t sum = http->received_bytes;

	for (size_t i = 0; i < http->socket_count; i++)
		sum += received_by(http->sockets[i]);
	return sum;
}

/* ---- event loop */

static int on_socket(CURL *easy, curl_socket_t fd, int what, void *data, void *known)
{
	struct http *http = data;
	struct epoll_event event = { .data.fd = fd };

	(void)easy;
	if (what == CURL_POLL_REMOVE) {
		epoll_ctl(http->epoll_fd, EPOLL_CTL_DEL, fd, NULL);
		return 0;
	}
	if (what & CURL_POLL_IN)
		event.events |= EPOLLIN;
	if (what & CURL_POLL_OUT)
		event.events |= EPOLLOUT;
	if (epoll_ctl(http->epoll_fd, known ? EPOLL_CTL_MOD : EPOLL_CTL_ADD, fd, &event) < 0)
		epoll_ctl(http->epoll_fd, errno == EEXIST ? EPOLL_CTL_MOD : EPOLL_CTL_ADD, fd,
			  &event);
	curl_multi_assign(http->multi, fd, http); /* `known` is not NULL from now on */
	return 0;
}

static int on_timer(CURLM *multi, long timeout_ms, void *data)
{
	struct http *http = data;
	struct itimerspec when = { 0 };

	(void)multi;
	if (timeout_ms == 0)
		when.it_value.tv_nsec = 1; /* now; zero would disarm the timer */
	if (timeout_ms > 0) {
		when.it_value.tv_sec = timeout_ms / 1000;
		when.it_value.tv_nsec = timeout_ms % 1000 * 1000000;
	}
	timerfd_settime(http->timer_fd, 0, &when, NULL);
	return 0;
}

/* ---- an answer's headers */

static bool header_is(const char *line, size_t size, const char *name)
{
	size_t length = strlen(name);

	return size > length && strncasecmp(line, name, length) == 0;
}

/* "content-range: bytes 100-199/5000" */
static bool range_begins_at(const char *line, size_t size, uint64_t first)
{
	char copy[128], *end;
	const char *at;

	snprintf(copy, sizeof(copy), "%.*s", (int)size, line);
	at = strstr(copy, "bytes");
	if (!at)
		return false;
	return strtoull(at + 5, &end, 10) == first && *end == '-';
}

static void take_etag(struct http_request *request, const char *text, size_t size)
{
	while (size > 0 && strchr("\r\n ", text[size - 1]))
		size--;
	while (size > 0 && *text == ' ') {
		text++;
		size--;
	}
	/* The ETag is sent back to the server in a request header, where a control character could
	 * start another header. */
	for (size_t i = 0; i < size; i++)
		if ((unsigned char)text[i] < ' ' || text[i] == 0x7f)
			return;
	/* a longer one is dropped: truncated, it would be a different ETag */
	if (size < sizeof(request->etag))
		snprintf(request->etag, sizeof(request->etag), "%.*s", (int)size, text);
}

/* Returns whether a whole file that is announced with this length ("content-length: 5000") is
 * larger than it may be, so that nothing of it is worth reading. */
static bool announces_too_much(struct http_request *request, const char *line, size_t size)
{
	char copy[64];
	long status = 0;

	curl_easy_getinfo(request->easy, CURLINFO_RESPONSE_CODE, &status);
	if (status != 200 || request->get.size > 0)
		return false;
	snprintf(copy, sizeof(copy), "%.*s", (int)size, line);
	return strtoull(copy + strlen("content-length:"), NULL, 10) > request->get.ceiling;
}

static size_t on_header(char *line, size_t one, size_t size, void *data)
{
	struct http_request *request = data;

	(void)one;
	request->header_bytes += size;
	if (request->header_bytes > HEADER_BYTES_MAX) { /* curl keeps them all in memory */
		request->refused = true;
		return 0;
	}
	/* also the header of the answer after a "100 Continue" */
	if (header_is(line, size, "HTTP/")) {
		request->range_is_right = false;
		request->etag[0] = '\0';
	} else if (header_is(line, size, "content-range:")) {
		request->range_is_right = range_begins_at(line, size, request->get.first);
	} else if (header_is(line, size, "content-length:") &&
		   announces_too_much(request, line, size)) {
		request->refused = true;
		return 0; /* curl then ends the request */
	} else if (header_is(line, size, "etag:")) {
		take_etag(request, line + 5, size - 5);
	}
	return size;
}

/* ---- an answer's body */

/* Called once the status is known. Returns false if the answer is not what we asked for. */
static bool judge_answer(struct http_request *request)
{
	curl_easy_getinfo(request->easy, CURLINFO_RESPONSE_CODE, &request->status);
	if (request->status == 206)
		return request->get.size > 0 && request->range_is_right;
	/* A server without range support sends the whole file. The bytes before our part are
	 * skipped. */
	if (request->status == 200 && request->get.size > 0)
		request->skip = request->get.first;
	return true;
}

static bool has_body_for_us(const struct http_request *request)
{
	return request->status == 0 || request->status == 200 || request->status == 206;
}

/* Passes a piece to the receiver. Returns false if no more bytes are needed or allowed. */
static bool pass_piece(struct http_request *request, struct bytes piece)
{
	uint64_t max = request->get.size ? request->get.size : request->get.ceiling;
	uint64_t room = max - request->passed;
	bool more;

	if (piece.size > room) {
		request->refused = request->get.size == 0; /* a whole file exceeds its ceiling */
		piece.size = (size_t)room;
		if (request->refused)
			return false;
	}
	if (piece.size == 0)
		return request->get.size == 0; /* the rest of the file was not asked for */
	more = request->get.receive(request->get.data, piece);
	request->passed += piece.size;
	return more && (request->get.size == 0 || request->passed < request->get.size ||
			request->status != 200);
}

static size_t on_body(char *data, size_t one, size_t size, void *user)
{
	struct http_request *request = user;
	struct bytes piece = { (const uint8_t *)data, size };

	(void)one;
	if (request->http->is_local)
		request->http->received_bytes += size;
	if (!request->body_began) {
		request->body_began = true;
		if (!judge_answer(request)) {
			request->refused = true;
			return 0;
		}
	}
	if (!has_body_for_us(request)) {
		request->ignored += size;
		return request->ignored > ERROR_BODY_BYTES_MAX ? 0 : size;
	}
	if (request->skip >= piece.size) {
		request->skip -= piece.size;
		return size;
	}
	piece.data += request->skip;
	piece.size -= (size_t)request->skip;
	request->skip = 0;
	if (pass_piece(request, piece))
		return size;
	request->enough = !request->refused;
	return 0; /* curl then ends the request */
}

/* ---- the end of a request */

static int judge_status(long status)
{
	switch (status) {
	case 200:
	case 206:
	case 304:
		return 0;
	case 401:
	case 403:
	case 404:
	case 410:
	case 416:
		return -ENOENT;
	default:
		return -EHOSTUNREACH;
	}
}

static int judge_code(struct http_request *request, CURLcode code)
{
	if (request->enough)
		return 0;
	if (request->refused)
		return -EBADMSG;
	if (code == CURLE_FILE_COULDNT_READ_FILE || code == CURLE_BAD_DOWNLOAD_RESUME ||
	    (request->http->is_local && code == CURLE_RANGE_ERROR)) {
		/* If the folder itself is gone (a stick was pulled out), treat it like a lost
		 * network. */
		return access(request->http->folder, F_OK) == 0 ? -ENOENT : -EHOSTUNREACH;
	}
	curl_easy_getinfo(request->easy, CURLINFO_RESPONSE_CODE, &request->status);
	if (request->went_astray)
		return -EHOSTUNREACH;
	if (code == CURLE_WRITE_ERROR) /* an error page that is too long */
		return judge_status(request->status) < 0 ? judge_status(request->status) : -EBADMSG;
	if (code != CURLE_OK)
		return -EHOSTUNREACH;
	return request->http->is_local ? 0 : judge_status(request->status);
}

static void release_request(struct http_request *request)
{
	curl_multi_remove_handle(request->http->multi, request->easy);
	curl_easy_cleanup(request->easy);
	curl_slist_free_all(request->headers);
	free(request);
}

/* Follows the answer's redirection. Returns false if there is none, or if it is not allowed. */
static bool follow(struct http_request *request, CURLcode code)
{
	const struct http *http = request->http;
	char *from = NULL, *to = NULL;

	if (code != CURLE_OK || http->is_local)
		return false;
	curl_easy_getinfo(request->easy, CURLINFO_EFFECTIVE_URL, &from);
	curl_easy_getinfo(request->easy, CURLINFO_REDIRECT_URL, &to);
	if (!to)
		return false;
	request->went_astray = true;
	if (request->redirects == REDIRECTS_MAX || !from ||
	    !redirect_allowed(http->url, from, to, http->redirect_hosts))
		return false;
	curl_multi_remove_handle(http->multi, request->easy);
	if (curl_easy_setopt(request->easy, CURLOPT_URL, to) != CURLE_OK)
		return false;
	request->redirects++;
	request->status = 0;
	request->body_began = request->range_is_right = false;
	request->ignored = request->header_bytes = 0;
	request->etag[0] = '\0';
	request->went_astray = curl_multi_add_handle(http->multi, request->easy) != CURLM_OK;
	return !request->went_astray;
}

static void finish_request(CURL *easy, CURLcode code)
{
	struct http_request *request = NULL;
	struct http_result result = { 0 };
	char why[CURL_ERROR_SIZE + 32];

	curl_easy_getinfo(easy, CURLINFO_PRIVATE, &request);
	if (follow(request, code))
		return;
	result.rc = judge_code(request, code);
	request->http->is_stalled = code == CURLE_OPERATION_TIMEDOUT && result.rc < 0;
	result.not_modified = result.rc == 0 && request->status == 304;
	result.etag = request->etag;
	result.why = why;
	if (request->went_astray)
		snprintf(why, sizeof(why), "it redirects to another host, or too often");
	else if (request->status >= 400)
		snprintf(why, sizeof(why), "HTTP status %ld", request->status);
	else if (request->refused)
		snprintf(why, sizeof(why), "another range than asked for, or too large");
	else if (code == CURLE_OK || request->enough)
		snprintf(why, sizeof(why), "fine");
	else if (code == CURLE_OPERATION_TIMEDOUT)
		snprintf(why, sizeof(why), "too slow: %s", request->error);
	else
		snprintf(why, sizeof(why), "%s",
			 request->error[0] ? request->error : curl_easy_strerror(code));
	curl_multi_remove_handle(request->http->multi, easy);
	request->get.done(request->get.data, &result);
	release_request(request);
}

static void finish_requests(struct http *http)
{
	CURLMsg *message;
	int left;

	while ((message = curl_multi_info_read(http->multi, &left)))
		if (message->msg == CURLMSG_DONE)
			finish_request(message->easy_handle, message->data.result);
}

int http_dispatch(struct http *http)
{
	struct epoll_event events[EVENTS];
	int count = epoll_wait(http->epoll_fd, events, EVENTS, 0);
	int running;

	for (int i = 0; i < count; i++) {
		uint64_t expirations;
		int bits = 0;

		if (events[i].data.fd == http->timer_fd) {
			if (read(http->timer_fd, &expirations, sizeof(expirations)) > 0)
				curl_multi_socket_action(http->multi, CURL_SOCKET_TIMEOUT, 0,
							 &running);
			continue;
		}
		if (events[i].events & EPOLLIN)
			bits |= CURL_CSELECT_IN;
		if (events[i].events & EPOLLOUT)
			bits |= CURL_CSELECT_OUT;
		if (events[i].events & (EPOLLERR | EPOLLHUP))
			bits |= CURL_CSELECT_ERR;
		curl_multi_socket_action(http->multi, events[i].data.fd, bits, &running);
	}
	finish_requests(http);
	return count < 0 && errno != EINTR ? -errno : 0;
}

int http_fd(const struct http *http)
{
	return http->epoll_fd;
}

const char *http_url(const struct http *http)
{
	return http->url;
}

/* ---- starting a request */

static void set_options(struct http_request *request)
{
	struct http *http = request->http;
	CURL *easy = request->easy;

	curl_easy_setopt(easy, CURLOPT_PRIVATE, request);
	curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, request->error);
	curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
	/* the end of a request does not wait for a name server that does not answer */
	curl_easy_setopt(easy, CURLOPT_QUICK_EXIT, 1L);
	/* the museum's server is reached without a proxy */
	curl_easy_setopt(easy, CURLOPT_NOPROXY, "*");
	curl_easy_setopt(easy, CURLOPT_USERAGENT, "gopura-fetch");
	curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, http->is_local ? "file" : "http,https");
	curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L); /* follow() checks each redirection */
	curl_easy_setopt(easy, CURLOPT_HTTP_VERSION, (long)CURL_HTTP_VERSION_2TLS);
	/* prefer sharing a connection to opening a new one */
	curl_easy_setopt(easy, CURLOPT_PIPEWAIT, 1L);
	/* But libcurl goes on using an HTTP/2 connection on which a request stalled. If a process
	 * of the server hangs, its kernel acknowledges for ever: this request closes it. */
	curl_easy_setopt(easy, CURLOPT_FORBID_REUSE, (long)http->is_stalled);
	curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, (long)CONNECT_MS);
	curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, (long)STALL_BYTES_PER_S);
	curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME, http->stall_s);
	curl_easy_setopt(easy, CURLOPT_OPENSOCKETFUNCTION, on_open);
	curl_easy_setopt(easy, CURLOPT_OPENSOCKETDATA, http);
	curl_easy_setopt(easy, CURLOPT_CLOSESOCKETFUNCTION, on_close);
	curl_easy_setopt(easy, CURLOPT_CLOSESOCKETDATA, http);
	curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, on_header);
	curl_easy_setopt(easy, CURLOPT_HEADERDATA, request);
	curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_body);
	curl_easy_setopt(easy, CURLOPT_WRITEDATA, request);
	if (http->ca_file)
		curl_easy_setopt(easy, CURLOPT_CAINFO, http->ca_file);
}

/* Time limit of a whole request. A server that sends a few bytes now and then never counts as
 * stalled, and would otherwise block a request for hours. */
static long time_limit_s(const struct http_request *request)
{
	const struct http_get *get = &request->get;
	uint64_t for_bytes_s = (get->size ? get->size : get->ceiling) / TRICKLE_BYTES_PER_S;

	if (for_bytes_s > TRICKLE_S_MAX)
		for_bytes_s = TRICKLE_S_MAX;
	return request->http->patience_s + (long)for_bytes_s;
}

static void set_request(struct http_request *request)
{
	const struct http_get *get = &request->get;
	char text[URL_BYTES_MAX + 256];

	curl_easy_setopt(request->easy, CURLOPT_TIMEOUT, time_limit_s(request));
	snprintf(text, sizeof(text), "%s/%s", request->http->url, get->path);
	curl_easy_setopt(request->easy, CURLOPT_URL, text);
	if (get->size > 0) {
		snprintf(text, sizeof(text), "%llu-%llu", (unsigned long long)get->first,
			 (unsigned long long)(get->first + get->size - 1));
		curl_easy_setopt(request->easy, CURLOPT_RANGE, text);
	}
	if (get->etag && get->etag[0]) {
		snprintf(text, sizeof(text), "If-None-Match: %s", get->etag);
		request->headers = curl_slist_append(NULL, text);
		curl_easy_setopt(request->easy, CURLOPT_HTTPHEADER, request->headers);
	}
	request->get.path = NULL; /* curl has copied what it needs */
	request->get.etag = NULL;
}

int http_get(struct http *http, const struct http_get *get, struct http_request **out)
{
	struct http_request *request = calloc(1, sizeof(*request));

	*out = NULL;
	if (!request)
		return -ENOMEM;
	request->http = http;
	request->get = *get;
	request->easy = curl_easy_init();
	if (!request->easy) {
		free(request);
		return -ENOMEM;
	}
	set_options(request);
	set_request(request);
	if (curl_multi_add_handle(http->multi, request->easy) != CURLM_OK) {
		curl_easy_cleanup(request->easy);
		curl_slist_free_all(request->headers);
		free(request);
		return -ENOMEM;
	}
	*out = request;
	return 0;
}

void http_cancel(struct http_request *request)
{
	if (request)
		release_request(request);
}

/* ---- create and destroy */

/* Writes a folder's path as a file:// url. Characters that a url cannot contain are
 * percent-encoded. */
static int url_of_folder(char *out, size_t size, const char *path)
{
	char whole[PATH_MAX], folder[PATH_MAX / 2];
	size_t used;

	if (path[0] != '/' && getcwd(folder, sizeof(folder)))
		snprintf(whole, sizeof(whole), "%s/%s", folder, path);
	else
		snprintf(whole, sizeof(whole), "%s", path);
	used = (size_t)snprintf(out, size, "file://");
	for (const char *at = whole; *at; at++) {
		bool plain = strchr("/-_.~", *at) || (*at >= '0' && *at <= '9') ||
			     (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z');

		if (used + 4 > size)
			return -EINVAL;
		used += (size_t)snprintf(out + used, size - used, plain ? "%c" : "%%%02X",
					 (unsigned char)*at);
	}
	return 0;
}

static int take_url(struct http *http, const char *url)
{
	size_t length;
	int rc = 0;

	if (strncmp(url, "https://", 8) == 0 || strncmp(url, "http://", 7) == 0)
		snprintf(http->url, sizeof(http->url), "%s", url);
	else if (strncmp(url, "file://", 7) == 0)
		rc = url_of_folder(http->url, sizeof(http->url), url + 7);
	else if (strstr(url, "://") || url[0] == '\0')
		rc = -EINVAL;
	else
		rc = url_of_folder(http->url, sizeof(http->url), url);
	http->is_local = strncmp(http->url, "file://", 7) == 0;
	if (http->is_local)
		snprintf(http->folder, sizeof(http->folder), "%s",
			 strncmp(url, "file://", 7) == 0 ? url + 7 : url);
	length = strlen(http->url);
	while (length > 8 && http->url[length - 1] == '/')
		http->url[--length] = '\0';
	if (strlen(url) >= sizeof(http->url))
		rc = -EINVAL;
	return rc;
}

static int open_loop(struct http *http)
{
	struct epoll_event event = { .events = EPOLLIN };

	http->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	http->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (http->epoll_fd < 0 || http->timer_fd < 0)
		return -errno;
	event.data.fd = http->timer_fd;
	if (epoll_ctl(http->epoll_fd, EPOLL_CTL_ADD, http->timer_fd, &event) < 0)
		return -errno;
	http->multi = curl_multi_init();
	if (!http->multi)
		return -ENOMEM;
	curl_multi_setopt(http->multi, CURLMOPT_SOCKETFUNCTION, on_socket);
	curl_multi_setopt(http->multi, CURLMOPT_SOCKETDATA, http);
	curl_multi_setopt(http->multi, CURLMOPT_TIMERFUNCTION, on_timer);
	curl_multi_setopt(http->multi, CURLMOPT_TIMERDATA, http);
	curl_multi_setopt(http->multi, CURLMOPT_PIPELINING, (long)CURLPIPE_MULTIPLEX);
	curl_multi_setopt(http->multi, CURLMOPT_MAX_HOST_CONNECTIONS, (long)CONNECTIONS_MAX);
	return 0;
}

static int copy_text(char **out, const char *text)
{
	if (!text)
		return 0;
	*out = strdup(text);
	return *out ? 0 : -ENOMEM;
}

int http_create(struct http **out, const struct http_options *options)
{
	struct http *http = calloc(1, sizeof(*http));
	int rc;

	*out = NULL;
	if (!http)
		return -ENOMEM;
	http->epoll_fd = http->timer_fd = -1;
	http->stall_s = options->stall_s ? (long)options->stall_s : STALL_S;
	http->patience_s = options->patience_s ? (long)options->patience_s : PATIENCE_S;
	rc = take_url(http, options->url);
	if (rc == 0 && !redirect_hosts_valid(options->redirect_hosts))
		rc = -EINVAL;
	if (rc == 0)
		rc = copy_text(&http->ca_file, options->ca_file);
	if (rc == 0)
		rc = copy_text(&http->redirect_hosts, options->redirect_hosts);
	if (rc == 0 && curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK)
		rc = -ENOMEM;
	if (rc == 0)
		rc = open_loop(http);
	if (rc < 0) {
		http_destroy(http);
		return rc;
	}
	*out = http;
	return 0;
}

void http_destroy(struct http *http)
{
	if (!http)
		return;
	curl_multi_cleanup(http->multi); /* NULL is fine; closes the sockets through on_close */
	if (http->timer_fd >= 0)
		close(http->timer_fd);
	if (http->epoll_fd >= 0)
		close(http->epoll_fd);
	free(http->ca_file);
	free(http->redirect_hosts);
	free(http);
}
