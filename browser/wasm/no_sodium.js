// A page has no lab key and no peer on a network, so nothing calls libsodium. The linker asks for its names.
mergeInto(LibraryManager.library, Object.fromEntries(
    ['crypto_aead_chacha20poly1305_ietf_decrypt', 'crypto_aead_chacha20poly1305_ietf_encrypt', 'crypto_generichash',
     'crypto_generichash_final', 'crypto_generichash_init', 'crypto_generichash_update', 'crypto_scalarmult',
     'crypto_scalarmult_base', 'sodium_memcmp', 'sodium_memzero'].map(
        (name) => [name, function() { abort('no libsodium in a page'); }])));
