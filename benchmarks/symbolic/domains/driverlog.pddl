; Drivers walk on paths and drive trucks on roads to deliver parcels.
;@ skill load 0 load ?p ?t
;@ skill unload 0 unload ?p ?t
;@ skill enter 0 enter ?d ?t
;@ skill leave 0 leave ?d
;@ skill drive 0 drive ?d ?to
;@ skill walk 0 walk ?d ?to
(define (domain driverlog)
 (:requirements :strips :typing)
 (:types place movable - object driver truck parcel - movable)
 (:predicates (at ?x - movable ?l - place) (in ?p - parcel ?t - truck) (driving ?d - driver ?t - truck)
  (empty ?t - truck) (road ?a ?b - place) (path ?a ?b - place))
 (:action load
  :parameters (?p - parcel ?t - truck ?l - place)
  :precondition (and (at ?t ?l) (at ?p ?l))
  :effect (and (in ?p ?t) (not (at ?p ?l))))
 (:action unload
  :parameters (?p - parcel ?t - truck ?l - place)
  :precondition (and (at ?t ?l) (in ?p ?t))
  :effect (and (at ?p ?l) (not (in ?p ?t))))
 (:action enter
  :parameters (?d - driver ?t - truck ?l - place)
  :precondition (and (at ?t ?l) (at ?d ?l) (empty ?t))
  :effect (and (driving ?d ?t) (not (at ?d ?l)) (not (empty ?t))))
 (:action leave
  :parameters (?d - driver ?t - truck ?l - place)
  :precondition (and (at ?t ?l) (driving ?d ?t))
  :effect (and (at ?d ?l) (empty ?t) (not (driving ?d ?t))))
 (:action drive
  :parameters (?t - truck ?from ?to - place ?d - driver)
  :precondition (and (at ?t ?from) (driving ?d ?t) (road ?from ?to))
  :effect (and (at ?t ?to) (not (at ?t ?from))))
 (:action walk
  :parameters (?d - driver ?from ?to - place)
  :precondition (and (at ?d ?from) (path ?from ?to))
  :effect (and (at ?d ?to) (not (at ?d ?from)))))
