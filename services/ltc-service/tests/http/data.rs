//! The tables in every form.

use axum::http::{Method, StatusCode};
use ltc_core::Matrix;
use ltc_service::{Limits, Settings};
use ltc_table::{Channels, Precision, Quantity, Table, digest::digest, npz};
use serde_json::Value;

use crate::support::*;

fn original(name: &str, version: &str) -> Table {
    catalogue().version(name, version).unwrap().table().clone()
}

#[tokio::test]
async fn the_default_is_the_payload() {
    let app = service().await;
    let payload = catalogue().version(ISO, "10").unwrap().payload().to_vec();
    for query in ["", "?", "?format=npz", "?precision=f64", "?channels=m,magnitude,fresnel,cells"] {
        let answer = get(&app, &at(ISO, "latest", &format!("/data{query}"))).await;
        assert_eq!(answer.status, StatusCode::OK);
        assert_eq!(answer.body, payload, "{query}");
        assert_eq!(answer.header("content-type"), "application/zip");
        let disposition = answer.header("content-disposition");
        assert_eq!(disposition, "attachment; filename=\"ggx-isotropic-10.npz\"");
        assert_eq!(answer.header("etag"), format!("\"{}\"", digest(&payload)));
        assert_eq!(answer.header("content-length"), payload.len().to_string());
    }
}

#[tokio::test]
async fn npz_comes_at_each_precision() {
    let app = service().await;
    for name in [ISO, ANISO] {
        let table = original(name, "1");
        for precision in Precision::ALL {
            let answer = get(&app, &at(name, "1", &format!("/data?precision={}", precision.name()))).await;
            let read = npz::read(&answer.body, table.axes()).unwrap();
            assert_eq!(read, table.rounded(precision).unwrap());
            if precision == Precision::F64 {
                assert_eq!(read, table);
            } else {
                assert_ne!(read, table, "rounding changes this table");
            }
        }
    }
}

#[tokio::test]
async fn channels_are_chosen() {
    let app = service().await;
    let table = original(ISO, "1");
    for names in ["m", "magnitude,fresnel", "fresnel", "m,cells"] {
        let answer = get(&app, &at(ISO, "1", &format!("/data?channels={names}"))).await;
        let channels = Channels::from_names(names).unwrap();
        assert_eq!(answer.body, npz::write(&table, Precision::F64, channels).unwrap(), "{names}");
        assert!(npz::read(&answer.body, table.axes()).is_err(), "something is left out");
    }
}

#[tokio::test]
async fn crops_keep_the_nodes_around_a_range() {
    let app = service().await;
    let answer =
        get(&app, &at(ANISO, "1", "/data?alpha=0.3..0.6&lambda=0.5..1&theta=0..0.4&precision=f32")).await;
    assert_eq!(answer.status, StatusCode::OK, "{:?}", answer.body);
    assert_eq!(
        answer.header("content-disposition"),
        "attachment; filename=\"ggx-anisotropic-1-f32-part.npz\""
    );
    let table = original(ANISO, "1");
    let part = table.crop(Quantity::Theta, 0.0, 0.4).unwrap();
    let part = part.crop(Quantity::Alpha, 0.3, 0.6).unwrap().crop(Quantity::Lambda, 0.5, 1.0).unwrap();
    assert_eq!(part.shape(), [2, 3, 3, 2]);
    let read = npz::read(&answer.body, part.axes()).unwrap();
    assert_eq!(read, part.rounded(Precision::F32).unwrap());
}

#[tokio::test]
async fn fresnel_is_the_two_channels_alone() {
    let app = service().await;
    let table = original(ISO, "2");
    let answer = get(&app, &at(ISO, "2", "/fresnel?precision=f32")).await;
    assert_eq!(answer.body, npz::write(&table, Precision::F32, Channels::FRESNEL).unwrap());
    assert_eq!(
        answer.header("content-disposition"),
        "attachment; filename=\"ggx-isotropic-2-f32-fresnel.npz\""
    );
    let json = get(&app, &at(ISO, "2", "/fresnel?format=json")).await.json();
    assert!(json.get("m").is_none());
    assert_eq!(json["magnitude"][0][0], table.magnitude()[0]);
    assert_eq!(json["fresnel"][5][6], table.fresnel()[41]);
    let refused = get(&app, &at(ISO, "2", "/fresnel?format=ktx2")).await;
    assert_eq!((refused.status, refused.field()), (StatusCode::UNPROCESSABLE_ENTITY, "format".to_owned()));
}

#[tokio::test]
async fn json_nests_the_arrays() {
    let app = service().await;
    let table = original(ANISO, "1");
    let answer = get(&app, &at(ANISO, "1", "/data?format=json")).await;
    assert_eq!(answer.header("content-type"), "application/json");
    assert_eq!(answer.header("content-disposition"), "inline; filename=\"ggx-anisotropic-1.json\"");
    let json = answer.json();
    assert_eq!(json["name"], ANISO);
    assert_eq!(json["digest"], digest_of(ANISO, "1"));
    assert_eq!(json["precision"], "f64");
    for axis in table.axes() {
        let nodes: Vec<f64> =
            serde_json::from_value(json[&format!("axis_{}", axis.quantity.name())].clone()).unwrap();
        assert_eq!(nodes, axis.nodes());
    }
    // Entry (2, 1, 3, 2) of a 4 × 3 × 5 × 3 table, row 0, column 2.
    let index = ((2 * 3 + 1) * 5 + 3) * 3 + 2;
    assert_eq!(json["m"][2][1][3][2][0][2], table.m()[index].to_row_array()[2]);
    assert_eq!(json["cell_tv"][2][1][3][2], table.cells().tv[index]);
    assert_eq!(lengths(&json["m"]), [4, 3, 5, 3, 3, 3]);
    let single =
        get(&app, &at(ANISO, "1", "/data?format=json&precision=f32&channels=magnitude")).await.json();
    assert_eq!(single["magnitude"][2][1][3][2], f64::from(table.magnitude()[index] as f32));
    assert!(single.get("m").is_none() && single.get("cell_tv").is_none());
}

fn lengths(nested: &Value) -> Vec<usize> {
    let Some(items) = nested.as_array() else { return Vec::new() };
    [&[items.len()][..], &lengths(&items[0])].concat()
}

#[tokio::test]
async fn ktx2_is_read_by_another_crate() {
    let app = service().await;
    for (query, format) in [
        ("", ktx2::Format::R32G32B32A32_SFLOAT),
        ("&precision=f16", ktx2::Format::R16G16B16A16_SFLOAT),
        ("&channels=m,magnitude,fresnel", ktx2::Format::R32G32B32A32_SFLOAT),
    ] {
        let answer = get(&app, &at(ISO, "1", &format!("/data?format=ktx2{query}"))).await;
        assert_eq!(answer.status, StatusCode::OK);
        assert_eq!(answer.header("content-type"), "image/ktx2");
        let reader = ktx2::Reader::new(&answer.body[..]).unwrap();
        assert_eq!(reader.header().format, Some(format));
        assert_eq!((reader.header().pixel_width, reader.header().pixel_height), (7, 6));
    }
}

#[tokio::test]
async fn a_cropped_texture_has_a_manifest_of_its_part() {
    let app = service().await;
    let answer = get(&app, &at(ISO, "1", "/data?format=ktx2&alpha=0.2..0.5")).await;
    let reader = ktx2::Reader::new(&answer.body[..]).unwrap();
    let manifest = reader.key_value_data().find(|(key, _)| *key == "LtcTable").unwrap().1;
    let manifest: Value = serde_json::from_slice(manifest.strip_suffix(b"\0").unwrap()).unwrap();
    let part = original(ISO, "1").crop(Quantity::Alpha, 0.2, 0.5).unwrap();
    assert_eq!(manifest["axes"], serde_json::to_value(part.axes()).unwrap());
    assert_eq!(reader.header().pixel_width as usize, part.axes()[1].len);
    assert_eq!(manifest["part"], serde_json::json!({"alpha": [0.2, 0.5]}));
    assert_eq!(manifest["digest"], digest_of(ISO, "1"));
}

#[tokio::test]
async fn parameters_that_mean_nothing_are_refused_by_name() {
    let app = service().await;
    for (name, query, status, field) in [
        (ISO, "format=exr", 422, "format"),
        (ISO, "format=", 422, "format"),
        (ISO, "precision=f8", 422, "precision"),
        (ISO, "precision=F32", 422, "precision"),
        (ISO, "format=ktx2&precision=f64", 422, "precision"),
        (ISO, "format=ktx2&channels=m", 422, "channels"),
        (ISO, "channels=", 422, "channels"),
        (ISO, "channels=m,colour", 422, "channels"),
        (ISO, "fromat=ktx2", 422, "fromat"),
        (ISO, "phi=0..1", 422, "phi"),
        (ISO, "format=npz&format=ktx2", 422, "format"),
        (ISO, "alpha=0.1", 400, "alpha"),
        (ISO, "alpha=0.1..", 400, "alpha"),
        (ISO, "alpha=..", 400, "alpha"),
        (ISO, "alpha=a..b", 400, "alpha"),
        (ISO, "alpha=NaN..0.5", 422, "alpha"),
        (ISO, "alpha=0..inf", 422, "alpha"),
        (ISO, "alpha=0.5..0.1", 422, "alpha"),
        (ISO, "alpha=0.5..1.5", 422, "alpha"),
        (ISO, "alpha=-1..0.5", 422, "alpha"),
        (ISO, "theta=0..3", 422, "theta"),
        (ISO, "lambda=0..1", 422, "lambda"),
        (ISO, "alpha=%zz", 400, "alpha"),
        (ISO, "%ff=1", 400, ""),
    ] {
        for method in [Method::GET, Method::HEAD] {
            let path = at(name, "1", &format!("/data?{query}"));
            let answer = ask_with(&app, method.clone(), &path, &[]).await;
            assert_eq!(answer.status.as_u16(), status, "{query}: {:?}", answer.body);
            if method == Method::GET {
                assert_eq!(answer.field(), field, "{query}");
            }
        }
    }
    for query in ["channels=m", "alpha=0..1", "format=ktx2"] {
        let answer = get(&app, &at(ISO, "1", &format!("/fresnel?{query}"))).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{query}");
    }
}

#[tokio::test]
async fn a_precision_that_cannot_hold_the_table_is_refused() {
    let mut catalogue = ltc_table::Catalogue::default();
    let small = table(isotropic(), 0.5);
    let large: Vec<_> = small.m().iter().map(|m| *m * 1e6).collect();
    let (magnitude, fresnel) = (small.magnitude().to_vec(), small.fresnel().to_vec());
    let large = Table::new(small.axes().to_vec(), large, magnitude, fresnel, small.cells().clone()).unwrap();
    catalogue.insert(version("large", 1, &large));
    let app = service_over(&catalogue, Settings::default()).await.0;
    for format in ["npz", "ktx2", "json"] {
        let answer = get(&app, &at("large", "1", &format!("/data?precision=f16&format={format}"))).await;
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert_eq!(answer.field(), "precision");
        let fits = get(&app, &at("large", "1", &format!("/data?precision=f32&format={format}"))).await;
        assert_eq!(fits.status, StatusCode::OK);
    }
}

#[tokio::test]
async fn variants_are_the_same_from_the_cache_without_one_and_all_at_once() {
    let path = at(ISO, "1", "/data?format=json&precision=f32");
    let cached = service().await;
    let first = get(&cached, &path).await;
    let again = get(&cached, &path).await;
    assert_eq!(again.body, first.body);
    assert_eq!(again.body.as_ptr(), first.body.as_ptr(), "not only equal: the same memory");
    let uncached = service_with(Limits { cache_bytes: 0, ..Limits::default() }).await;
    let (one, two) = (get(&uncached, &path).await, get(&uncached, &path).await);
    assert_eq!((&one.body, &two.body), (&first.body, &first.body));
    assert_ne!(one.body.as_ptr(), two.body.as_ptr());
    // Different variants asked for at the same time do not get each other's bytes.
    let together = service().await;
    let tasks = (0..64).map(|i| {
        let app = together.clone();
        let (version, precision) = (["1", "2", "10"][i % 3], ["f16", "f32", "f64"][i % 5 % 3]);
        let path = at(ISO, version, &format!("/data?channels=m&precision={precision}"));
        tokio::spawn(async move {
            let answer = get(&app, &path).await;
            let alone = get(&service().await, &path).await;
            assert_eq!(answer.body, alone.body);
            answer.header("etag").to_owned()
        })
    });
    let mut tags = std::collections::BTreeSet::new();
    for task in tasks.collect::<Vec<_>>() {
        tags.insert(task.await.unwrap());
    }
    assert_eq!(tags.len(), 9, "three versions at three precisions");
}
