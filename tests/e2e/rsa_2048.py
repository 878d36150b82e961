"""A plugin of pytest: RSA keys of 2048 bits in place of 3072. The conformance suite of The Update Framework makes 28 of
them as it starts, which took 16 of its 25 seconds of processor; a client must take 2048 bits too."""
from cryptography.hazmat.primitives.asymmetric import rsa

_generate = rsa.generate_private_key
rsa.generate_private_key = lambda public_exponent, key_size, backend=None: _generate(public_exponent, 2048)
