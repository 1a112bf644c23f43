//! `ltc token`, `backup` and `restore`.

use tempfile::tempdir;

use crate::support::{ltc, names_in, text};

#[test]
fn tokens_are_made_listed_and_revoked() {
    let folder = tempdir().unwrap();
    let data = folder.path().join("data");
    let token = |args: &[&str]| ltc(&[&["token"], args, &["--data", text(&data)]].concat());
    token(&["list"]).refused(&["there is no store in", "data"]);
    assert!(!data.exists(), "looking makes nothing");
    let made =
        token(&["create", "--scope", "refit,publish", "--label", "a pipeline", "--expires", "90d"]).good();
    let secret = made.out.trim_end();
    assert!(secret.starts_with("ltc_") && !secret.contains(char::is_whitespace), "{secret}");
    assert!(made.err.contains("shown this once") && !made.err.contains(secret), "{}", made.err);
    let id = secret.split('_').nth(1).unwrap();
    let listed = token(&["list", "--json"]).json();
    assert_eq!(listed[0]["id"], id);
    assert_eq!(listed[0]["scopes"], serde_json::json!(["refit", "publish"]));
    assert_eq!((&listed[0]["label"], &listed[0]["ended"]), (&"a pipeline".into(), &false.into()));
    let listing = token(&["list"]).good().out;
    assert!(listing.contains(id) && listing.contains("a pipeline"), "{listing}");
    // The secret is in no file: nothing but a hash is kept.
    let hidden = secret.rsplit_once('_').unwrap().1.as_bytes();
    for name in names_in(&data).into_iter().filter(|name| name.starts_with("ltc.sqlite")) {
        let bytes = std::fs::read(data.join(&name)).unwrap();
        assert!(!bytes.windows(hidden.len()).any(|window| window == hidden), "it is in {name}");
    }
    token(&["revoke", id]).good();
    token(&["revoke", id]).refused(&["there is no token", id]);
    assert_eq!(token(&["list", "--json"]).json(), serde_json::json!([]));
    token(&["create", "--scope", "admin"]).misused(&["there is no scope", "publish"]);
    token(&["create"]).misused(&["required"]);
    token(&["create", "--scope", "read", "--expires", "2001-01-01"]).misused(&["over already"]);
}

#[test]
fn a_backup_is_restored_elsewhere_and_overwrites_nothing() {
    let folder = tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (data, backup, restored) = (at("data"), at("backup"), at("restored"));
    ltc(&["backup", "--data", text(&data), "-o", text(&backup)]).refused(&["there is no store", "data"]);
    assert!(!backup.exists());
    let create = |data| ltc(&["token", "create", "--data", data, "--scope", "read"]).good();
    create(text(&data));
    let contents = ltc(&["backup", "--data", text(&data), "-o", text(&backup), "--json"]).json();
    assert_eq!(contents["format"], 1);
    let again = ltc(&["backup", "--data", text(&data), "-o", text(&backup)]);
    again.refused(&["is not empty", "backup"]);
    let said = ltc(&["restore", text(&backup), "--data", text(&restored)]).good().out;
    assert!(said.contains("restored to"), "{said}");
    let list = |data| ltc(&["token", "list", "--data", data, "--json"]).json();
    assert_eq!(list(text(&restored)), list(text(&data)));
    ltc(&["restore", text(&backup), "--data", text(&restored)]).refused(&["is not empty"]);
    ltc(&["restore", text(&data), "--data", text(&at("new"))]).refused(&["no complete backup"]);
}
